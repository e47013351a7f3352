"""Add shapes to a scene that is about to be drawn: marks that neither models nor states know of."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose

_EMISSION = 0.3
_UPRIGHT = Pose.identity().quaternion_wxyz

Color = NDArray[np.float32]


def add_shape(
    scene: mujoco.MjvScene, kind: int, size: NDArray[np.float64], pose_in_world: Pose, rgba: Color
) -> None:
    """Add one see-through shape, of a kind and size as geoms have them; nothing where the scene is full."""
    if scene.ngeom >= scene.maxgeom:
        return
    drawn, rotation = scene.geoms[scene.ngeom], pose_in_world.rotation_matrix().ravel()
    mujoco.mjv_initGeom(drawn, kind, size, pose_in_world.position, rotation, rgba)
    drawn.category, drawn.transparent, drawn.emission = mujoco.mjtCatBit.mjCAT_DECOR, 1, _EMISSION
    scene.ngeom += 1


def add_column(
    scene: mujoco.MjvScene,
    foot_in_world: tuple[float, float, float],
    height_m: float,
    radius_m: float,
    rgba: Color,
) -> None:
    """Add an upright cylinder that stands on `foot_in_world` (metres)."""
    x, y, z = foot_in_world
    place = Pose(np.array([x, y, z + height_m / 2]), _UPRIGHT)
    size = np.array([radius_m, height_m / 2, 0.0])
    add_shape(scene, int(mujoco.mjtGeom.mjGEOM_CYLINDER), size, place, rgba)
