"""What a training leaves on the disk: checkpoints of every seed, and what it needs to go on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

import torch
from safetensors.torch import save
from torch import Tensor

from mart.protocol.control_rate import same_control_hz
from mart.protocol.errors import InvalidInput
from mart.runtime.atomic_directory import write_directory_atomically
from mart.trainer.data.dataset import DataDigest
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.checkpoint import RECORD, WEIGHTS, CheckpointRecord, read_record, read_weights
from mart.trainer.models.hyperparameters import Hyperparameters
from mart.trainer.train.run_directory import RunDirectory

_STATE = "state.safetensors"
# Shared by all seeds; every other weight has a model axis, a seed's models beside each other.
_SHARED = ("normaliser.", "model.scale.")
_RESIDUAL = "model.residual."


def write_checkpoint(
    run: RunDirectory,
    updates: int,
    seeds: Sequence[int],
    weights: Mapping[str, Tensor],
    *,
    digest: DataDigest,
    layout: ObservationLayout,
    sizes: Hyperparameters,
    model: ModelSpec,
) -> None:
    """Write one checkpoint a seed; they come to be together or not at all."""
    files = {}
    for index, seed in enumerate(seeds):
        record = CheckpointRecord(
            name=model.name,
            model=model,
            task=digest.task,
            control_hz=digest.control_hz,
            arms=digest.arms,
            arm_kinds=digest.arm_kinds,
            layout=layout.fields,
            hyperparameters=sizes,
            seed=seed,
            updates=updates,
            data_sha256=digest.sha256,
            versions={name: version(name) for name in ("mart-trainer", "torch")},
        )
        own = {name: _of_seed(name, value, index, len(seeds)) for name, value in weights.items()}
        files[f"seed-{seed}/{RECORD}"] = record.model_dump_json(indent=2).encode()
        files[f"seed-{seed}/{WEIGHTS}"] = save(own)
    write_directory_atomically(run.checkpoints / str(updates), files)


def read_base(
    folder: Path, seeds: Sequence[int], model: ModelSpec, layout: ObservationLayout, control_hz: float
) -> dict[str, Tensor]:
    """Return planners, actors and normalisation of another run's seeds, as weights of this one.

    folder: a run, whose newest checkpoint is taken, or one of its checkpoints (`…/checkpoints/4000`).
    Raises InvalidInput where that run's model is not the base of this one, has another rate, or lacks a seed.
    """
    run = RunDirectory(folder if (folder / "checkpoints").is_dir() else folder.parent.parent)
    updates = run.checkpointed()[-1] if run.path == folder and run.checkpointed() else _number(folder)
    found = []
    for seed in seeds:
        path = run.checkpoint(updates, seed)
        record = read_record(path)
        base = record.model.model_copy(update={"residual": "none"})
        if base != model.model_copy(update={"residual": "none"}) or record.layout != layout.fields:
            raise InvalidInput(
                f"{path} is a {record.name} of {record.task}; a base must have the planner and actor of {model.name}, "
                "and be of the same task."
            )
        if not same_control_hz(record.control_hz, control_hz):
            raise InvalidInput(
                f"{path} learned at {record.control_hz:g} Hz and its residual would at {control_hz:g}; "
                f"give --control-hz {record.control_hz:g}."
            )
        found.append(read_weights(path))
    return {
        name: found[0][name] if name.startswith(_SHARED) else torch.cat([own[name] for own in found])
        for name in found[0]
        if not name.startswith(_RESIDUAL)
    }


def _of_seed(name: str, value: Tensor, index: int, seeds: int) -> Tensor:
    value = value.detach().cpu()
    return value if name.startswith(_SHARED) else value.chunk(seeds)[index].contiguous()


def _number(folder: Path) -> int:
    if not folder.name.isdigit():
        raise InvalidInput(f"The base {folder} is no run with checkpoints, nor one of its checkpoints.")
    return int(folder.name)
