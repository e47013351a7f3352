"""Files with the last states of worlds that went out of bounds: `data/diverged/{when}-{who}-{task}.npz`.

last = divergence.load(path)
world = World.build(last.task, last.control_hz, arms=last.actions.shape[1])
world.set_integration_state(last.states[0].tobytes())
for actions in last.actions:
    world.step(actions)
"""

from __future__ import annotations

import zipfile
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from mart.protocol import clock
from mart.protocol.errors import Corrupt
from mart.sim.world import Diverged, LastStates

MOST_FILES = 100  # the oldest make room


class Keeper:
    """Writes them into one folder and explains the divergence. `who`: the room or the replica."""

    def __init__(self, folder: Path, who: str) -> None:
        self._folder, self._who = folder, who

    def __call__(self, diverged: Diverged) -> str:
        """What happened, in words, and where the last states are; a disk that is full stops nothing."""
        try:
            return f"{diverged} Its last states are in {self._save(diverged.last)}."
        except OSError as error:
            return f"{diverged} Its last states could not be kept: {error}."

    def _save(self, last: LastStates) -> Path:
        self._folder.mkdir(parents=True, exist_ok=True)
        for old in sorted(self._folder.glob("*.npz"))[: -MOST_FILES + 1]:
            old.unlink(missing_ok=True)
        when = datetime.fromtimestamp(clock.wall_ns() / 1e9, UTC).strftime("%Y-%m-%dT%H%M%S.%f")
        path = self._folder / f"{when}-{self._who}-{last.task}.npz"
        with path.open("xb") as file:
            np.savez(file, **vars(last))
        return path


def load(path: Path) -> LastStates:
    """Raises Corrupt where the file is not one of these."""
    try:
        with np.load(path, allow_pickle=False) as kept:
            return LastStates(
                task=str(kept["task"]),
                control_hz=float(kept["control_hz"]),
                model_sha256=str(kept["model_sha256"]),
                states=kept["states"],
                actions=kept["actions"],
            )
    except (OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise Corrupt(f"{path} holds no last states of a world ({error}); choose another file.") from error
