"""Keep the last states of worlds that went out of bounds in files: `data/diverged/{when}-{owner}-{task}.npz`.

last = divergence.load(path)
world = World.build(last.task, last.control_hz, arms=last.actions.shape[1], kinds=last.arm_kinds)
world.set_integration_state(last.states[0].tobytes())
for actions in last.actions:
    world.step(actions)
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from mart.protocol.errors import Corrupt
from mart.runtime.atomic_file import PUBLIC, write_atomically
from mart.sim.world import Diverged, LastStates

MOST_FILES = 100  # the oldest make room


class DivergenceArchive:
    """Keep the last states of diverged worlds in one folder, `MOST_FILES` at most.

    owner: the room or replica whose worlds they are, part of each file's name. wall_ns: tells the time, nanoseconds.
    """

    def __init__(self, folder: Path, owner: str, wall_ns: Callable[[], int]) -> None:
        self._folder, self._owner, self._wall_ns = folder, owner, wall_ns

    def keep(self, diverged: Diverged) -> str:
        """Write the last states; return in words what happened and where they are. A full disk stops nothing."""
        try:
            return f"{diverged} Its last states are in {self._save(diverged.last)}."
        except OSError as error:
            return f"{diverged} Its last states could not be kept: {error}."

    def _save(self, last: LastStates) -> Path:
        for old in sorted(self._folder.glob("*.npz"))[: -MOST_FILES + 1]:
            old.unlink(missing_ok=True)
        when = datetime.fromtimestamp(self._wall_ns() / 1e9, UTC).strftime("%Y-%m-%dT%H%M%S.%f")
        path = self._folder / f"{when}-{self._owner}-{last.task}.npz"
        packed = io.BytesIO()
        np.savez(packed, **vars(last))
        write_atomically(path, packed.getvalue(), PUBLIC)
        return path


def load(path: Path) -> LastStates:
    """Read the last states of a world from `path`; raises Corrupt where it holds none."""
    try:
        with np.load(path, allow_pickle=False) as kept:
            return LastStates(
                task=str(kept["task"]),
                control_hz=float(kept["control_hz"]),
                model_sha256=str(kept["model_sha256"]),
                states=kept["states"],
                actions=kept["actions"],
                arm_kinds=tuple(map(str, kept["arm_kinds"])) if "arm_kinds" in kept else (),
            )
    except (OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise Corrupt(f"{path} holds no last states of a world ({error}); choose another file.") from error
