"""What a training needs to go on exactly where it was, beside its checkpoints."""

from __future__ import annotations

import shutil
from collections.abc import Mapping

from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import Tensor

from mart.protocol.errors import Corrupt
from mart.runtime.atomic_directory import write_directory_atomically
from mart.trainer.train.run_directory import RunDirectory

_STATE = "state.safetensors"


def write_state(run: RunDirectory, updates: int, state: Mapping[str, Tensor]) -> None:
    """Keep what a continuation after so many updates needs; what was kept before goes."""
    whole = {name: value.cpu().contiguous() for name, value in state.items()}
    write_directory_atomically(run.resume / str(updates), {_STATE: save(whole)})
    for older in run.resume.iterdir():
        if older.name != str(updates):
            shutil.rmtree(older)


def read_state(run: RunDirectory) -> tuple[int, dict[str, Tensor]] | None:
    """Return the newest state, and after how many updates it was kept; None where a run has not come so far."""
    kept = sorted((path for path in run.resume.glob("*") if path.name.isdigit()), key=lambda p: int(p.name))
    if not kept:
        return None
    try:
        return int(kept[-1].name), load((kept[-1] / _STATE).read_bytes())
    except (SafetensorError, OSError) as error:
        raise Corrupt(f"{kept[-1]} is damaged: {error}; start a new run.") from error
