"""A checkpoint: a directory with `weights.safetensors` and `checkpoint.json`. No pickle, and never half of one.

It is written under a temporary name, synced and renamed: a directory that has its name is complete.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, ValidationError
from safetensors import SafetensorError

from mart.protocol.errors import Corrupt, NotFound
from mart.trainer.grid import Model
from mart.trainer.presets import Hyperparameters

if TYPE_CHECKING:
    import torch

FORMAT = 1
RECORD = "checkpoint.json"
WEIGHTS = "weights.safetensors"
_HALF = ".half"


class Seen(BaseModel):
    """One observation that a model was trained on: as in the task catalogue, kept so that a change is noticed."""

    model_config = ConfigDict(frozen=True)

    name: str
    shape: tuple[int, ...]
    unit: str
    arms: tuple[str, ...]


class CheckpointRecord(BaseModel):
    """What stands beside the weights."""

    model_config = ConfigDict(frozen=True)

    format: int = FORMAT
    name: str  # of the model, as the paper calls it
    model: Model
    task: str
    control_hz: float
    arms: tuple[str, ...]
    layout: tuple[Seen, ...]
    hyperparameters: Hyperparameters
    seed: int
    updates: int
    data_sha256: str  # digest of what it was trained on; the run's data.json lists it
    versions: Mapping[str, str]


def write_directory(path: Path, fill: Mapping[str, bytes]) -> None:
    """A directory with these files, at once and on the disk when this returns. One that is there stays as it is."""
    half = path.with_name(path.name + _HALF)
    shutil.rmtree(half, ignore_errors=True)
    for name, content in fill.items():
        file = half / name
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("wb") as opened:
            opened.write(content)
            opened.flush()
            os.fsync(opened.fileno())
    for folder in {half, *((half / name).parent for name in fill)}:
        _sync(folder)
    if path.exists():
        shutil.rmtree(half)
        return
    half.rename(path)
    _sync(path.parent)


def read_record(path: Path) -> CheckpointRecord:
    """Raises NotFound where there is no checkpoint and Corrupt where it is of another format or damaged."""
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
    """By name, on the CPU. Raises NotFound where they are missing and Corrupt where the file is damaged."""
    from safetensors.torch import load_file

    file = path / WEIGHTS
    if not file.is_file():
        raise NotFound(f"There is no {file}; name a directory that holds {RECORD} and {WEIGHTS}.")
    try:
        return load_file(file)
    except (SafetensorError, OSError) as error:
        raise Corrupt(f"{file} is damaged: {error}; use another checkpoint or train again.") from error


def _sync(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
