"""Say where each number of an observation vector belongs: the catalogue's names as columns.

The joint observation of a task is the concatenation of its named observations, in the catalogue's order; an arm's
part is what its operator sees, in the same order. Parts overlap where arms see the same thing.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import Task, get_task

_QUATERNION = "wxyz"
_NO_ROTATION = 1e-6


class ObservationField(BaseModel):
    """One observation that a model was trained on: as in the task catalogue, kept so that a change is noticed."""

    model_config = ConfigDict(frozen=True)

    name: str
    shape: tuple[int, ...]
    unit: str
    arms: tuple[str, ...]


@dataclass(frozen=True)
class ObservationLayout:
    """Columns of the joint observation. `fields`: in their order."""

    arms: tuple[str, ...]
    fields: tuple[ObservationField, ...]

    @classmethod
    def of(cls, task: Task) -> ObservationLayout:
        """Return the layout of a task's observations, all arms together."""
        fields = (
            ObservationField(name=o.name, shape=o.shape, unit=o.unit, arms=o.arms) for o in task.observations
        )
        return cls(task.arm_names, tuple(fields))

    @classmethod
    def of_arms(cls, task: str, arms: int, kinds: Sequence[str] = ()) -> ObservationLayout:
        """Return the layout of a task with so many arms, of these kinds; none of them: Pandas.

        Raises NotFound for an unknown task or kind and InvalidInput for a number of arms that it cannot have.
        """
        return cls.of(get_task(task, arms, kinds))

    @property
    def sha256(self) -> str:
        """Two layouts with the same digest put the same things into the same columns."""
        said = ";".join(f"{field.name} {field.shape} {field.unit}" for field in self.fields)
        return hashlib.sha256(f"{self.arms};{said}".encode()).hexdigest()

    @property
    def width(self) -> int:
        """How many columns there are."""
        return sum(_size(field) for field in self.fields)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the observations, in the order of their columns."""
        return tuple(field.name for field in self.fields)

    def columns_of(self, arm: str) -> NDArray[np.int64]:
        """Return the columns that this arm's operator sees, int64, rising."""
        if arm not in self.arms:
            raise NotFound.named("arm", arm, self.arms)
        return self._columns([arm in field.arms for field in self.fields])

    def names_of(self, arm: str) -> tuple[str, ...]:
        """Return the names of the observations that this arm's operator sees."""
        return tuple(field.name for field in self.fields if arm in field.arms)

    def groups(self) -> NDArray[np.int64]:
        """Return for each column, int64[width], the index of the observation that it is a part of."""
        return np.repeat(np.arange(len(self.fields)), [_size(field) for field in self.fields])

    def vector(self, observations: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float32]:
        """Join named arrays, each [rows, *shape], to float32[rows, width]; quaternions get a canonical sign.

        Raises InvalidInput where one is missing, of another shape, or not finite.
        """
        parts = [_part(field, observations) for field in self.fields]
        joined = np.concatenate(parts, axis=1, dtype=np.float32, casting="same_kind")
        if not np.isfinite(joined).all():
            bad = self.fields[int(self.groups()[np.nonzero(~np.isfinite(joined))[1][0]])]
            raise InvalidInput(
                f"The observation {bad.name} holds NaN or infinity; every number must be finite."
            )
        return joined

    def _columns(self, chosen: list[bool]) -> NDArray[np.int64]:
        return np.flatnonzero(np.repeat(chosen, [_size(field) for field in self.fields]))


def _size(field: ObservationField) -> int:
    return int(np.prod(field.shape, dtype=np.int64))


def _part(field: ObservationField, observations: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    if field.name not in observations:
        raise InvalidInput(f"The observation {field.name} is missing; this task gives every arm's, by name.")
    value = np.asarray(observations[field.name], dtype=np.float64)
    if value.shape[1:] != field.shape:
        raise InvalidInput(
            f"The observation {field.name} has shape {value.shape[1:]}; the model takes {field.shape}."
        )
    flat = value.reshape(len(value), -1)
    return canonical(flat) if field.unit == _QUATERNION else flat


def canonical(quaternions_wxyz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return for each quaternion [rows, 4] the one of q and -q whose first component that is not zero is positive."""
    clear = np.abs(quaternions_wxyz) > _NO_ROTATION
    first = np.take_along_axis(quaternions_wxyz, clear.argmax(axis=1)[:, None], axis=1)
    return quaternions_wxyz * np.where(first < 0, -1.0, 1.0)
