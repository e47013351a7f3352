"""robomimic: the peer of everything that trains."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from support.peers import Peer, running

from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import Task
from mart.recorder.export.robomimic import key_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Updates:
    """What some updates took, and what robomimic logged about them: means over them, by its own names."""

    version: str
    took_s: float
    losses: dict[str, float]
    parameters: int
    windows: int


class Robomimic:
    def __init__(self, peer: Peer) -> None:
        self._peer = peer

    def update(self, number: int) -> Updates:
        self._peer.tell(str(number))
        return Updates(**self._peer.answer())


@contextmanager
def robomimic(file: Path, algorithm: str) -> Iterator[Robomimic]:
    """`algorithm`: bc or hbc, ready to learn from an HDF5 file."""
    with running("robomimic", "train.py", file, algorithm) as peer:
        yield Robomimic(peer)


class RobomimicPolicy:
    """What robomimic has learned, as a policy of ours that drives all arms (mart.policies.Policy)."""

    control_hz = 20.0

    def __init__(self, peer: Peer, task: Task) -> None:
        self._peer = peer
        self.task, self.arms, self.arm_kinds = task.name, task.arm_names, task.arm_kinds
        self.needs = tuple(observation.name for observation in task.observations)
        self.version: str = peer.answer()["version"]

    def begin(self, worlds: int, seed: int) -> None:
        """Its samples are of its own seed, whatever `seed` is."""
        self._peer.tell("null")

    def act(self, observations: Mapping[str, Array]) -> Array:
        rows = {
            key_of(name): values.reshape(len(values), -1).tolist() for name, values in observations.items()
        }
        self._peer.tell(json.dumps(rows))
        actions = np.array(self._peer.answer()["actions"])
        return actions.reshape(len(actions), len(self.arms), ACTION_SIZE)

    def only(self, arm: str) -> RobomimicPolicy:
        raise InvalidInput(f"{arm} was asked for alone; one network drives {', '.join(self.arms)} together.")


@contextmanager
def robomimic_policy(
    file: Path, algorithm: str, task: Task, *, seed: int, updates: int, sizes: Mapping[str, Any]
) -> Iterator[RobomimicPolicy]:
    """Learned from the successful episodes of an HDF5 file."""
    arguments = (algorithm, str(seed), str(updates), json.dumps(sizes))
    with running("robomimic", "play.py", file, *arguments) as peer:
        yield RobomimicPolicy(peer, task)
