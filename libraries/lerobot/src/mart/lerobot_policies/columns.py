"""Lay MART's observations out as the vectors that a policy of LeRobot takes, and its action by arms. Pure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import Corrupt, InvalidInput

Array = NDArray[np.float64]


def observations_of(names: Sequence[str]) -> dict[str, list[int]]:
    """Return by observation which of its numbers, flat, are named: `arm0/gripper/0` is number 0 of `arm0/gripper`.

    Raises Corrupt for a name that is none.
    """
    found: dict[str, list[int]] = {}
    for name in names:
        observation, _, index = name.rpartition("/")
        if not (observation and index.isascii() and index.isdecimal()):
            raise Corrupt(
                f"The number {name[:100]!r} is named, which is none of an observation, such as arm0/gripper/0."
            )
        found.setdefault(observation, []).append(int(index))
    return found


def vector(names: Sequence[str], observations: Mapping[str, NDArray[np.generic]]) -> NDArray[np.float32]:
    """Return float32[worlds, len(names)]. observations: by name, each float64[worlds, *shape].

    Raises InvalidInput for an observation that is missing, too small, or not finite.
    """
    columns = []
    for name in names:
        observation, _, index = name.rpartition("/")
        values = observations.get(observation)
        flat = None if values is None else values.reshape(len(values), -1)
        if flat is None or int(index) >= flat.shape[1]:
            raise InvalidInput(f"The policy is shown no {name}, which it was trained with.")
        columns.append(flat[:, int(index)])
    found = np.stack(columns, axis=1).astype(np.float32)
    if not np.isfinite(found).all():
        raise InvalidInput("An observation holds NaN or infinity; every number must be finite.")
    return found


def actions(given: NDArray[np.generic], arms: int) -> Array:
    """Return float64[worlds, arms, 7] in [-1, 1]: LeRobot's policies give what is beyond, too.

    Raises Corrupt for another size, and for what is no number.
    """
    numbers = np.asarray(given, dtype=np.float64)
    if numbers.ndim != 2 or numbers.shape[1] != arms * ACTION_SIZE or not np.isfinite(numbers).all():
        raise Corrupt(
            f"The policy gave an action of shape {numbers.shape}, not {arms * ACTION_SIZE} finite numbers a world."
        )
    return np.clip(numbers, -1.0, 1.0).reshape(len(numbers), arms, ACTION_SIZE)
