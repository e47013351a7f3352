"""Build the room: floor, table, pedestals, light, cameras; and the solver settings that every task shares.

World z = 0 is the table top; the arms' bases stand level with it, just beyond the table's edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.tasks import Task
from mart.sim.scene import floor, tabletop
from mart.sim.scene.palette import add_materials, rgba
from mart.sim.scene.shadows import add_shadow, add_shadow_material

TABLE_HALF_M = (0.60, 0.55)
_TABLE_THICKNESS_M = 0.04
FLOOR_Z_M = -0.75
_FLOOR_HALF_M = 8.0  # beyond what any camera that looks down can see
_BOX, _PLANE, _CYLINDER = (
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_PLANE,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
)


@dataclass(frozen=True)
class FixedCamera:
    """Place a camera at `position`, looking at `target` (both in the world frame, metres), upright."""

    name: str
    position: tuple[float, float, float]
    target: tuple[float, float, float]
    fovy_deg: float


def configure(spec: mujoco.MjSpec, timestep_s: float) -> None:
    """Set solver and rendering. Newton's iteration limit stays at its default: capping it makes things fly apart."""
    option = spec.option
    option.timestep = timestep_s
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = 100
    # The dense solver needs up to 45 ms for the tick in which a second gripper closes.
    option.jacobian = mujoco.mjtJacobian.mjJAC_SPARSE
    # Whatever hands hold is one island with them; finding the others costs more than it saves: 5 to 15 % of a step.
    option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ISLAND)
    visual = spec.visual
    visual.map.znear = 0.02
    visual.quality.offsamples = 0
    # Of round things: MuJoCo's 28 and 16 make 900 triangles of every cylinder, 1.5 ms a frame with a tray of drinks.
    visual.quality.numslices, visual.quality.numstacks = 24, 6
    visual.global_.offwidth, visual.global_.offheight = 1280, 960


def add_room(spec: mujoco.MjSpec, task: Task) -> None:
    """Add table, pedestals, rug, floor and light."""
    _add_materials(spec, task)
    add_shadow_material(spec)
    _add_light(spec)
    world, looks = spec.worldbody, {"contype": 0, "conaffinity": 0}
    if task.file is None or task.file.scene.furniture:
        _add_table(world)
    for arm in task.arms:
        x, y, z = arm.pose_base_in_world.position
        world.add_geom(
            type=_CYLINDER,
            size=(0.10, -FLOOR_Z_M / 2 - 0.012 + z / 2, 0),
            pos=(x, y, FLOOR_Z_M / 2 - 0.012 + z / 2),
            material="metal",
            **looks,
        )
        world.add_geom(
            type=_CYLINDER,
            size=(0.125, 0.012, 0),
            pos=(x, y, z - 0.012),
            material="paint",
            rgba=rgba(arm.color),
            **looks,
        )
        add_shadow(spec, arm.name, radius_m=0.065, tint=arm.color)
    world.add_geom(
        type=_PLANE, size=(*floor.RUG_HALF_M, 0.1), pos=(0, 0, FLOOR_Z_M + 0.004), material="rug", **looks
    )
    world.add_geom(
        type=_PLANE,
        size=(_FLOOR_HALF_M, _FLOOR_HALF_M, 0.1),
        pos=(0, 0, FLOOR_Z_M),
        material="floor",
        **looks,
    )


def _add_table(world: mujoco.MjsBody) -> None:
    looks = {"contype": 0, "conaffinity": 0}
    half_x, half_y = TABLE_HALF_M
    # Front to back: what is drawn first spares what it hides, which software rendering feels.
    world.add_geom(type=_PLANE, size=(half_x, half_y, 0.1), pos=(0, 0, 0.0003), material="table", **looks)
    world.add_geom(
        name="table",
        type=_BOX,
        size=(half_x, half_y, _TABLE_THICKNESS_M / 2),
        pos=(0, 0, -_TABLE_THICKNESS_M / 2),
        material="edge",
    )
    for x in (-1, 1):
        for y in (-1, 1):
            leg = (x * (half_x - 0.06), y * (half_y - 0.06), (FLOOR_Z_M - _TABLE_THICKNESS_M) / 2)
            size = (0.022, (-FLOOR_Z_M - _TABLE_THICKNESS_M) / 2, 0)
            world.add_geom(type=_CYLINDER, size=size, pos=leg, material="metal", **looks)


def _add_light(spec: mujoco.MjSpec) -> None:
    """Add a warm window at the front left, a cool sky at the back right, and a little from where one looks."""
    headlight = spec.visual.headlight
    headlight.ambient, headlight.diffuse, headlight.specular = (0.36, 0.37, 0.39), (0.14,) * 3, (0.0,) * 3
    for direction, strength, tint in (
        ((0.50, 0.45, -1.0), 0.50, (1.0, 0.96, 0.90)),
        ((-0.7, -0.35, -0.6), 0.20, (0.86, 0.93, 1.0)),
    ):
        diffuse = strength * np.array(tint)
        spec.worldbody.add_light(
            type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
            dir=direction,
            pos=-2.0 * np.array(direction),  # shadows fall from here on
            diffuse=diffuse,
            specular=0.4 * diffuse,
            castshadow=False,
        )


def add_camera(spec: mujoco.MjSpec, camera: FixedCamera) -> None:
    """Add a camera under its name."""
    position, target = np.array(camera.position), np.array(camera.target)
    back = position - target
    back /= np.linalg.norm(back)
    right = np.cross((0, 0, 1), back)
    right /= np.linalg.norm(right)
    axes = np.column_stack([right, np.cross(back, right), back])
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, axes.flatten())
    spec.worldbody.add_camera(name=camera.name, pos=position, quat=quaternion, fovy=camera.fovy_deg)


def _add_materials(spec: mujoco.MjSpec, task: Task) -> None:
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=rgba("#F4F6F8")[:3],
        rgb2=rgba("#C3CBD3")[:3],
        width=64,
        height=384,
    )
    add_materials(spec)
    _add_picture(spec, "table", tabletop.picture(task, *TABLE_HALF_M))
    _add_picture(spec, "rug", floor.rug())
    _add_picture(spec, "floor", floor.boards())
    tiles = 2 * _FLOOR_HALF_M / floor.TILE_M
    spec.material("floor").texrepeat = (tiles, tiles)


def _add_picture(spec: mujoco.MjSpec, material: str, picture: NDArray[np.uint8]) -> None:
    height, width, channels = picture.shape
    texture = spec.add_texture(
        name=material, type=mujoco.mjtTexture.mjTEXTURE_2D, width=width, height=height, nchannel=channels
    )
    texture.data = picture.tobytes()
    spec.material(material).textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = material
