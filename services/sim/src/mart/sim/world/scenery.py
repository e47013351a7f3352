"""The room: floor, table, pedestals, light, cameras; and the solver settings that every task shares.

World z = 0 is the table top; the arms' bases stand level with it, just beyond the table's edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from mart.protocol.tasks import Task
from mart.sim.world.palette import rgba

TABLE_HALF_M = (0.60, 0.55)
_TABLE_THICKNESS_M = 0.04
FLOOR_Z_M = -0.75
_BOX = mujoco.mjtGeom.mjGEOM_BOX


@dataclass(frozen=True)
class Camera:
    """A fixed camera at `position` that looks at `target` (both in the world frame, metres), upright."""

    name: str
    position: tuple[float, float, float]
    target: tuple[float, float, float]
    fovy_deg: float


def configure(spec: mujoco.MjSpec, timestep_s: float) -> None:
    """Solver and rendering. Newton's iteration limit stays at its default: capping it makes things fly apart."""
    option = spec.option
    option.timestep = timestep_s
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = 100
    # The dense solver needs up to 45 ms for the tick in which a second gripper closes.
    option.jacobian = mujoco.mjtJacobian.mjJAC_SPARSE
    visual = spec.visual
    visual.headlight.ambient, visual.headlight.diffuse, visual.headlight.specular = (0.3,) * 3, (0.35,) * 3, (0,) * 3
    visual.map.znear = 0.02
    visual.quality.offsamples = 0
    visual.global_.offwidth, visual.global_.offheight = 1280, 960


def add_room(spec: mujoco.MjSpec, task: Task) -> None:
    _add_materials(spec)
    world = spec.worldbody
    world.add_light(type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, dir=(-0.3, 0.4, -1), diffuse=(0.4,) * 3, castshadow=False)
    world.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE, size=(3, 3, 0.1), pos=(0, 0, FLOOR_Z_M), material="floor", contype=0, conaffinity=0
    )
    world.add_geom(
        name="table", type=_BOX, size=(*TABLE_HALF_M, _TABLE_THICKNESS_M / 2), pos=(0, 0, -_TABLE_THICKNESS_M / 2), material="table"
    )
    for arm in task.arms:
        x, y, _ = arm.pose_base_in_world.position
        world.add_geom(
            type=_BOX, size=(0.11, 0.11, -FLOOR_Z_M / 2), pos=(x, y, FLOOR_Z_M / 2), material="metal", contype=0, conaffinity=0
        )


def add_camera(spec: mujoco.MjSpec, camera: Camera) -> None:
    position, target = np.array(camera.position), np.array(camera.target)
    back = position - target
    back /= np.linalg.norm(back)
    right = np.cross((0, 0, 1), back)
    right /= np.linalg.norm(right)
    axes = np.column_stack([right, np.cross(back, right), back])
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, axes.flatten())
    spec.worldbody.add_camera(name=camera.name, pos=position, quat=quaternion, fovy=camera.fovy_deg)


def _add_materials(spec: mujoco.MjSpec) -> None:
    spec.add_texture(
        name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=rgba("#E8EDF2")[:3], rgb2=rgba("#B9C4CF")[:3], width=64, height=64,
    )
    for name, color, specular, shininess in (
        ("floor", "#C9CCD1", 0.0, 0.0),
        ("table", "#E6DFD3", 0.1, 0.1),
        ("metal", "#6B7178", 0.3, 0.3),
        ("shell", "#F2F3F4", 0.4, 0.4),
        ("rubber", "#33373B", 0.1, 0.1),
        ("matt", "#FFFFFF", 0.1, 0.1),
    ):
        spec.add_material(name=name, rgba=rgba(color), specular=specular, shininess=shininess)
