"""What acts: the one interface of scripted rollouts, seats and evaluation to a trained model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from mart.protocol.batch_state import ACTION_SIZE

if TYPE_CHECKING:
    from mart.render import PictureSpec  # with MuJoCo behind it

__all__ = ["ACTION_SIZE", "Array", "Policy", "SeeingPolicy", "pictures_of"]

Array = NDArray[np.float64]


class Policy(Protocol):
    """Acts in `worlds` worlds at once, once a tick. What it remembers between ticks starts anew with `begin`."""

    @property
    def task(self) -> str: ...

    @property
    def control_hz(self) -> float: ...

    @property
    def arms(self) -> tuple[str, ...]:
        """Names of the arms that it drives, in the order of `act`."""
        ...

    @property
    def arm_kinds(self) -> tuple[str, ...]:
        """What its task's arms are, one for each of the task; none: all are Pandas."""
        ...

    @property
    def needs(self) -> tuple[str, ...]:
        """Names of the observations that `act` reads."""
        ...

    def begin(self, worlds: int, seed: int) -> None:
        """Begin an episode, before its first tick. World i draws its samples from (seed, i), however many there are."""
        ...

    def act(self, observations: Mapping[str, NDArray[Any]]) -> Array:
        """Return what to do next, given the observations of now.

        observations: by name, each float64[worlds, *shape]; more than `needs` may be there.
        Returns float64[worlds, len(arms), 7] within [-1, 1].
        Raises InvalidInput where one is missing, of another shape or not finite.
        """
        ...

    def only(self, arm: str) -> Policy:
        """Return the part that drives `arm` alone, with a memory of its own.

        Raises NotFound for an unknown arm and InvalidInput where the arms are driven together, saying which.
        """
        ...


@runtime_checkable
class SeeingPolicy(Policy, Protocol):
    """A policy that is shown pictures, too: `act` finds each by its name among the observations.

    A picture is uint8[worlds, height, width, 3], sRGB, drawn of the very state that the other observations are of.
    """

    @property
    def pictures(self) -> Mapping[str, PictureSpec]:
        """What it is shown, by name; no name is that of an observation."""
        ...


def pictures_of(policy: Policy) -> Mapping[str, PictureSpec]:
    """Return what a policy is shown by name; nothing of one that does not see."""
    return policy.pictures if isinstance(policy, SeeingPolicy) else {}
