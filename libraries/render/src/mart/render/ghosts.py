"""Add a yellow, see-through copy of a thing to a scene that is about to be drawn, and a plumb line under it.

One picture alone does not tell how far away something floats; where it is above does. Models and states know nothing
of any of it.
"""

from __future__ import annotations

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Ghost
from mart.render.decor import add_column, add_shape

# Okabe & Ito's yellow: no arm has it.
_COLOR = np.array([0.94, 0.89, 0.26, 0.60], np.float32)
_PLUMB_RADIUS_M, _FOOT_RADIUS_M, _FOOT_THICKNESS_M = 0.004, 0.04, 0.001
_HIDDEN_GROUP = 3


def add_ghost(scene: mujoco.MjvScene, model: mujoco.MjModel, ghost: Ghost) -> None:
    """Add what is seen of the ghost's body, at the ghost's pose; nothing where the model has no such body."""
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, ghost.body)
    if body < 0:
        return
    first = int(model.body_geomadr[body])
    for geom in range(first, first + int(model.body_geomnum[body])):
        if model.geom_group[geom] < _HIDDEN_GROUP and model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH:
            in_body = Pose(model.geom_pos[geom].copy(), model.geom_quat[geom].copy())
            pose_in_world = ghost.pose_in_world @ in_body
            add_shape(scene, int(model.geom_type[geom]), model.geom_size[geom], pose_in_world, _COLOR)
    _add_plumb_line(scene, ghost)


def _add_plumb_line(scene: mujoco.MjvScene, ghost: Ghost) -> None:
    x, y, top = ghost.pose_in_world.position.tolist()
    foot = (x, y, ghost.floor_z_m)
    add_column(scene, foot, top - ghost.floor_z_m, _PLUMB_RADIUS_M, _COLOR)
    add_column(scene, foot, _FOOT_THICKNESS_M, _FOOT_RADIUS_M, _COLOR)
