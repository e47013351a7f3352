"""Where each number of an observation vector belongs: the catalogue's names as columns.

The joint observation of a task is the concatenation of its named observations, in the catalogue's order; an arm's
part is what its operator sees, in the same order. Parts overlap where arms see the same thing.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import Task, get_task
from mart.trainer.checkpoint import Seen

_QUATERNION = "wxyz"
_NO_ROTATION = 1e-6


@dataclass(frozen=True)
class Layout:
    """Columns of the joint observation. `seen`: in their order."""

    arms: tuple[str, ...]
    seen: tuple[Seen, ...]

    @classmethod
    def of(cls, task: Task) -> Layout:
        seen = (Seen(name=o.name, shape=o.shape, unit=o.unit, arms=o.arms) for o in task.observations)
        return cls(task.arm_names, tuple(seen))

    @classmethod
    def of_arms(cls, task: str, arms: int) -> Layout:
        """Raises NotFound for an unknown task and InvalidInput for a number of arms that it cannot have."""
        return cls.of(get_task(task, arms))

    @property
    def sha256(self) -> str:
        """Two layouts with the same digest put the same things into the same columns."""
        said = ";".join(f"{seen.name} {seen.shape} {seen.unit}" for seen in self.seen)
        return hashlib.sha256(f"{self.arms};{said}".encode()).hexdigest()

    @property
    def width(self) -> int:
        return sum(_size(seen) for seen in self.seen)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(seen.name for seen in self.seen)

    def columns_of(self, arm: str) -> NDArray[np.int64]:
        """The columns that this arm's operator sees, rising."""
        if arm not in self.arms:
            raise NotFound.named("arm", arm, self.arms)
        return self._columns([arm in seen.arms for seen in self.seen])

    def names_of(self, arm: str) -> tuple[str, ...]:
        return tuple(seen.name for seen in self.seen if arm in seen.arms)

    def groups(self) -> NDArray[np.int64]:
        """For each column the index of the observation that it is a part of."""
        return np.repeat(np.arange(len(self.seen)), [_size(seen) for seen in self.seen])

    def vector(self, observations: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float32]:
        """Named arrays, each [rows, *shape], as one [rows, width]; quaternions get a canonical sign.

        Raises InvalidInput where one is missing, of another shape, or not finite.
        """
        parts = [_part(seen, observations) for seen in self.seen]
        joined = np.concatenate(parts, axis=1, dtype=np.float32, casting="same_kind")
        if not np.isfinite(joined).all():
            bad = self.seen[int(self.groups()[np.nonzero(~np.isfinite(joined))[1][0]])]
            raise InvalidInput(
                f"The observation {bad.name} holds NaN or infinity; every number must be finite."
            )
        return joined

    def _columns(self, chosen: list[bool]) -> NDArray[np.int64]:
        return np.flatnonzero(np.repeat(chosen, [_size(seen) for seen in self.seen]))


def _size(seen: Seen) -> int:
    return int(np.prod(seen.shape, dtype=np.int64))


def _part(seen: Seen, observations: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    if seen.name not in observations:
        raise InvalidInput(f"The observation {seen.name} is missing; this task gives every arm's, by name.")
    value = np.asarray(observations[seen.name], dtype=np.float64)
    if value.shape[1:] != seen.shape:
        raise InvalidInput(
            f"The observation {seen.name} has shape {value.shape[1:]}; the model takes {seen.shape}."
        )
    flat = value.reshape(len(value), -1)
    return canonical(flat) if seen.unit == _QUATERNION else flat


def canonical(quaternions_wxyz: NDArray[np.float64]) -> NDArray[np.float64]:
    """[rows, 4]: of the two that are the same rotation, the one whose first component that is not zero is positive."""
    clear = np.abs(quaternions_wxyz) > _NO_ROTATION
    first = np.take_along_axis(quaternions_wxyz, clear.argmax(axis=1)[:, None], axis=1)
    return quaternions_wxyz * np.where(first < 0, -1.0, 1.0)
