"""Lay dirt on the table: overlapping spots, each of which is gone once a sponge has been over it.

What has been wiped is in the scene's memory. To look at, spots are mocap bodies: a wiped one moves into the table top,
so that everybody who renders the state sees it gone, and the physics has nothing to do with it.
"""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.tasks.three_arm_lift_wiping import SPOTS_M
from mart.sim.scene.data import Array, Data, Flags, into_frame, within
from mart.sim.scene.palette import MATERIALS, rgba

_RADIUS_M = 0.046  # of what is painted
_PIXELS = 64
_ALPHA = 0.95
_SHOWN_Z_M, _LAYER_M, _HIDDEN_Z_M = 0.0004, 0.00001, -0.02  # the table top is 4 cm thick
_TOUCHING_M = 0.003  # sponges give


def add_dirt(spec: mujoco.MjSpec) -> None:
    """Add the spots, all of them visible."""
    texture = spec.add_texture(
        name="dirt", type=mujoco.mjtTexture.mjTEXTURE_2D, width=_PIXELS, height=_PIXELS, nchannel=4
    )
    texture.data = _smudge().tobytes()
    spec.material("dirt").textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "dirt"
    for index, (x, y) in enumerate(SPOTS_M):
        turn = 2.4 * index  # the golden angle: no two neighbours look alike
        spot = spec.worldbody.add_body(
            name=f"dirt{index}",
            mocap=True,
            pos=(x, y, _SHOWN_Z_M + index * _LAYER_M),
            quat=(math.cos(turn / 2), 0, 0, math.sin(turn / 2)),
        )
        spot.add_geom(
            type=mujoco.mjtGeom.mjGEOM_PLANE,
            size=(_RADIUS_M, _RADIUS_M, 0.1),
            material="dirt",
            rgba=(
                *rgba(MATERIALS["dirt"].color)[:3],
                _ALPHA,
            ),  # below 1: blended, so the texture's own alpha counts
            contype=0,
            conaffinity=0,
        )


class Dirt:
    """View the spots in a world's state, or in a batch's: shapes (...) are () or (worlds,)."""

    def __init__(
        self, data: Data, wiped: Array, sponge: Any, sponge_half_m: tuple[float, float, float]
    ) -> None:
        """Attach; wiped: 1 where it is, shape (..., spots), in the state.

        sponge: a view of its body, or of a site in its middle.
        """
        self.wiped = wiped
        self._position = sponge.xpos
        self._rotation = sponge.xmat.reshape(*sponge.xmat.shape[:-1], 3, 3)
        half_x, half_y, half_z = sponge_half_m
        self._face_in_sponge, self._reach_m = np.array((0.0, 0.0, -half_z)), (half_x, half_y, _TOUCHING_M)
        self._spots = np.array([(x, y, 0.0) for x, y in SPOTS_M])
        first = int(data.model.body("dirt0").mocapid[0])
        self._heights = data.mocap_pos[..., first : first + len(SPOTS_M), 2]

    def wipe(self) -> None:
        """Mark what the sponge touches as wiped, and hide it."""
        np.maximum(self.wiped, self._touched(), out=self.wiped)
        self._heights[self.wiped > 0] = _HIDDEN_Z_M

    def is_gone(self) -> Flags:
        """Return whether every spot is wiped, shape (...)."""
        return np.logical_and.reduce(self.wiped, axis=-1)

    def _touched(self) -> Flags:
        """Return which spots lie under the sponge's face and against it, shape (..., spots)."""
        from_sponge = self._spots - self._position[..., None, :]
        from_face = into_frame(self._rotation[..., None, :, :], from_sponge) - self._face_in_sponge
        return within(from_face, self._reach_m)


def _smudge() -> NDArray[np.uint8]:
    """Draw a white blot with a ragged, fading edge, shape (rows, columns, 4)."""
    axis = np.linspace(-1, 1, _PIXELS)
    x, y = np.meshgrid(axis, axis)
    angle = np.arctan2(y, x)
    ragged = 0.80 + 0.10 * np.sin(3 * angle + 0.7) + 0.07 * np.sin(7 * angle + 2.1)
    edge = np.clip((ragged - np.hypot(x, y)) / 0.45, 0.0, 1.0)
    grain = 0.85 + 0.15 * np.sin(9 * x + 4 * y) * np.sin(11 * y - 3 * x)
    image = np.ones((_PIXELS, _PIXELS, 4))
    image[..., 3] = grain * edge * edge * (3 - 2 * edge)
    return (255 * image).round().astype(np.uint8)
