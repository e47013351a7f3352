"""Draw what policies that see are shown in their rollouts."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack, closing
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mart.protocol.messages import Model
from mart.render import StatePictures, load_model
from mart.trainer.models.policies.policy import Array, Policy, pictures_of


class RolloutPictures:
    """Draw the pictures of these policies, of worlds of one model, on the thread that made it."""

    def __init__(self, model: Model, policies: Sequence[Policy]) -> None:
        """Raise NotFound for a viewpoint that the model has not, Unavailable where this machine draws nothing."""
        loaded = load_model(
            model.mjb, sha256=model.sha256, mujoco_version=model.mujoco_version, source="the rollouts"
        )
        with ExitStack() as opened:
            self._drawn = {
                id(policy): opened.enter_context(closing(StatePictures(loaded, pictures_of(policy))))
                for policy in policies
            }
            self._opened = opened.pop_all()

    def draw(self, policy: Policy, states: Array, wanted: NDArray[np.bool_]) -> dict[str, NDArray[np.uint8]]:
        """Return by name uint8[worlds, height, width, 3]; black where a world has ended, since nobody looks at it.

        states: float64[worlds, size], MuJoCo's integration states. wanted: bool[worlds].
        """
        found = {
            name: np.zeros((len(states), one.height_px, one.width_px, 3), np.uint8)
            for name, one in pictures_of(policy).items()
        }
        for world in np.flatnonzero(wanted):
            state = states[world].astype("<f8").tobytes()
            for name, picture in self._drawn[id(policy)].draw(state).items():
                found[name][world] = picture
        return found

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()
