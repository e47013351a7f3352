"""What a training leaves on the disk: checkpoints of every seed, and what it needs to go on."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

import torch
from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import Tensor

from mart.protocol.errors import Corrupt, InvalidInput
from mart.trainer.checkpoint import (
    RECORD,
    WEIGHTS,
    CheckpointRecord,
    read_record,
    read_weights,
    write_directory,
)
from mart.trainer.data.dataset import Digest
from mart.trainer.data.layout import Layout
from mart.trainer.grid import Model
from mart.trainer.presets import Hyperparameters
from mart.trainer.runs import RunDirectory

_STATE = "state.safetensors"
_SHARED = (
    "normaliser."  # by all seeds; every other weight has a model axis, a seed's models beside each other
)
_BASE = ("model.planner.", "model.actor.", _SHARED)


def write_checkpoint(
    run: RunDirectory,
    updates: int,
    seeds: Sequence[int],
    weights: Mapping[str, Tensor],
    *,
    digest: Digest,
    layout: Layout,
    sizes: Hyperparameters,
    model: Model,
) -> None:
    """One checkpoint a seed. They come to be together or not at all."""
    files = {}
    for index, seed in enumerate(seeds):
        record = CheckpointRecord(
            name=model.name,
            model=model,
            task=digest.task,
            control_hz=digest.control_hz,
            arms=digest.arms,
            layout=layout.seen,
            hyperparameters=sizes,
            seed=seed,
            updates=updates,
            data_sha256=digest.sha256,
            versions={name: version(name) for name in ("mart-trainer", "torch")},
        )
        own = {name: _of_seed(name, value, index, len(seeds)) for name, value in weights.items()}
        files[f"seed-{seed}/{RECORD}"] = record.model_dump_json(indent=2).encode()
        files[f"seed-{seed}/{WEIGHTS}"] = save(own)
    write_directory(run.checkpoints / str(updates), files)


def write_state(run: RunDirectory, updates: int, state: Mapping[str, Tensor]) -> None:
    """What `read_state` reads; what was kept before goes."""
    whole = {name: value.cpu().contiguous() for name, value in state.items()}
    write_directory(run.resume / str(updates), {_STATE: save(whole)})
    for older in run.resume.iterdir():
        if older.name != str(updates):
            shutil.rmtree(older)


def read_state(run: RunDirectory) -> tuple[int, dict[str, Tensor]] | None:
    """The newest, and after how many updates it was kept; None where a run has not come so far."""
    kept = sorted((path for path in run.resume.glob("*") if path.name.isdigit()), key=lambda p: int(p.name))
    if not kept:
        return None
    try:
        return int(kept[-1].name), load((kept[-1] / _STATE).read_bytes())
    except (SafetensorError, OSError) as error:
        raise Corrupt(f"{kept[-1]} is damaged: {error}; start a new run.") from error


def read_base(folder: Path, seeds: Sequence[int], model: Model, layout: Layout) -> dict[str, Tensor]:
    """Planners, actors and normalisation of another run's seeds, as weights of this one.

    folder: a run, whose newest checkpoint is taken, or one of its checkpoints (`…/checkpoints/4000`).
    Raises InvalidInput where that run's model is not the base of this one, or lacks a seed.
    """
    run = RunDirectory(folder if (folder / "checkpoints").is_dir() else folder.parent.parent)
    updates = run.checkpointed()[-1] if run.path == folder and run.checkpointed() else _number(folder)
    found = []
    for seed in seeds:
        path = run.checkpoint(updates, seed)
        record = read_record(path)
        base = record.model.model_copy(update={"residual": "none"})
        if base != model.model_copy(update={"residual": "none"}) or record.layout != layout.seen:
            raise InvalidInput(
                f"{path} is a {record.name} of {record.task}; a base must have the planner and actor of {model.name}, "
                "and be of the same task."
            )
        found.append(read_weights(path))
    return {
        name: found[0][name] if name.startswith(_SHARED) else torch.cat([own[name] for own in found])
        for name in found[0]
        if name.startswith(_BASE)
    }


def write_json(path: Path, text: str) -> None:
    """At once: a reader finds the old file or the new one."""
    half = path.with_name(path.name + ".half")
    half.write_text(json.dumps(json.loads(text), indent=2) + "\n")
    half.replace(path)


def _of_seed(name: str, value: Tensor, index: int, seeds: int) -> Tensor:
    value = value.detach().cpu()
    return value if name.startswith(_SHARED) else value.chunk(seeds)[index].contiguous()


def _number(folder: Path) -> int:
    if not folder.name.isdigit():
        raise InvalidInput(f"The base {folder} is no run with checkpoints, nor one of its checkpoints.")
    return int(folder.name)
