"""A checkpoint: a directory with `weights.safetensors` and `checkpoint.json`. No pickle, and never half of one.

It is written under a temporary name, synced and renamed: a directory that has its name is complete.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, ValidationError
from safetensors import SafetensorError

from mart.protocol.errors import Corrupt, NotFound
from mart.trainer.data.layout import ObservationField
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.hyperparameters import Hyperparameters

if TYPE_CHECKING:
    import torch

FORMAT = 1
RECORD = "checkpoint.json"
WEIGHTS = "weights.safetensors"


class CheckpointRecord(BaseModel):
    """What `checkpoint.json` says about the weights beside it."""

    model_config = ConfigDict(frozen=True)

    format: int = FORMAT
    name: str  # of the model, as the paper calls it
    model: ModelSpec
    task: str
    control_hz: float
    arms: tuple[str, ...]
    arm_kinds: tuple[str, ...] = ()  # one for each arm; none: Pandas
    layout: tuple[ObservationField, ...]
    hyperparameters: Hyperparameters
    seed: int
    updates: int
    data_sha256: str  # digest of what it was trained on; the run's data.json lists it
    versions: Mapping[str, str]


def read_record(path: Path) -> CheckpointRecord:
    """Read the record of a checkpoint.

    Raises NotFound where there is no checkpoint and Corrupt where it is of another format or damaged.
    """
    file = path / RECORD
    if not file.is_file():
        raise NotFound(f"There is no checkpoint {path}; name a directory that holds {RECORD}.")
    try:
        record = CheckpointRecord.model_validate_json(file.read_bytes())
    except ValidationError as error:
        fault = error.errors()[0]
        where = ".".join(map(str, fault["loc"])) or "it"
        raise Corrupt(f"{file} cannot be read: {where}: {fault['msg']}; train again.") from error
    if record.format != FORMAT:
        raise Corrupt(f"{path} is of format {record.format}; this version reads {FORMAT}: train again.")
    return record


def read_weights(path: Path) -> dict[str, torch.Tensor]:
    """Read the weights of a checkpoint by name, on the CPU.

    Raises NotFound where they are missing and Corrupt where the file is damaged.
    """
    from safetensors.torch import load_file

    file = path / WEIGHTS
    if not file.is_file():
        raise NotFound(f"There is no {file}; name a directory that holds {RECORD} and {WEIGHTS}.")
    try:
        return load_file(file)
    except (SafetensorError, OSError) as error:
        raise Corrupt(f"{file} is damaged: {error}; use another checkpoint or train again.") from error
