"""Add what the practice course consists of: marks that float, a cube and a dish for each arm, a plank for two."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from mart.protocol.tasks import Arm
from mart.sim.scene.gripper import GRASPABLE
from mart.sim.scene.palette import rgba
from mart.sim.scene.shadows import add_shadow
from mart.sim.scene.symbols import add_tile
from mart.sim.tasks.tray import HALF_M, add_handle

CUBE_HALF_M = 0.02
DISH_HALF_M = 0.06
_CUBE_KG, _PLANK_KG = 0.1, 0.35
_BALL_RADIUS_M, _BAR_HALF_M = 0.018, (0.045, 0.010, 0.010)
_THREAD_RADIUS_M = 0.0015
_RIM_HALF_M, _RIM_HEIGHT_M = 0.003, 0.008
PLANK_HALF_M = (HALF_M[0], 0.06, 0.01)
# Where things begin, give or take: in the arm's base frame, the plank in the world.
BALL_AT_M, BAR_AT_M = (0.44, -0.14, 0.22), (0.44, 0.14, 0.16)
CUBE_AT_M, DISH_AT_M = (0.47, 0.30), (0.47, -0.30)
PLANK_AT_M = (0.0, 0.10)

_BOX, _SPHERE, _CYLINDER = (
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_SPHERE,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
)
_LOOKS = {"contype": 0, "conaffinity": 0, "mass": 0}


def add_marks(spec: mujoco.MjSpec, arm: Arm) -> None:
    """Add the ball and the bar, each on a thread that shows over which place of the table it floats."""
    number, look = arm.name.removeprefix("arm"), {"material": "paint", "rgba": rgba(arm.color), **_LOOKS}
    for name, place, shape in (
        ("ball", BALL_AT_M, {"type": _SPHERE, "size": (_BALL_RADIUS_M, 0, 0)}),
        ("bar", BAR_AT_M, {"type": _BOX, "size": _BAR_HALF_M}),
    ):
        mark = spec.worldbody.add_body(name=f"{name}{number}", mocap=True, pos=place)
        mark.add_geom(**shape, **look)
        mark.add_geom(
            type=_CYLINDER, fromto=(0, 0, 0, 0, 0, -place[2]), size=(_THREAD_RADIUS_M, 0, 0), **look
        )


def add_cube(spec: mujoco.MjSpec, arm: Arm) -> None:
    """Add the cube in the arm's colour."""
    name = f"cube{arm.name.removeprefix('arm')}"
    cube = spec.worldbody.add_body(name=name, pos=(*CUBE_AT_M, CUBE_HALF_M))
    cube.add_freejoint(name=name)
    cube.add_geom(
        name=name,
        type=_BOX,
        size=(CUBE_HALF_M,) * 3,
        mass=_CUBE_KG,
        material="paint",
        rgba=rgba(arm.color),
        **GRASPABLE,
    )
    add_tile(spec, cube, arm.symbol, radius_m=0.009, position=(0.0, 0.0, CUBE_HALF_M), normal=(0.0, 0.0, 1.0))
    add_shadow(spec, name, radius_m=0.05)


def add_dish(spec: mujoco.MjSpec, arm: Arm) -> None:
    """Add a flat dish with a low rim in the arm's colour."""
    dish = spec.worldbody.add_body(name=f"dish{arm.name.removeprefix('arm')}", mocap=True)
    floor_half_m = (DISH_HALF_M, DISH_HALF_M, 0.0005)
    dish.add_geom(type=_BOX, size=floor_half_m, pos=(0, 0, 0.0006), material="linen", **_LOOKS)
    out, half_z = DISH_HALF_M + _RIM_HALF_M, _RIM_HEIGHT_M / 2
    for x, y, half_x, half_y in (
        (0, -out, out, _RIM_HALF_M),
        (0, out, out, _RIM_HALF_M),
        (-out, 0, _RIM_HALF_M, out),
        (out, 0, _RIM_HALF_M, out),
    ):
        dish.add_geom(
            type=_BOX,
            size=(half_x, half_y, half_z),
            pos=(x, y, half_z),
            material="paint",
            rgba=rgba(arm.color),
        )


def add_plank(spec: mujoco.MjSpec, arms: Sequence[Arm]) -> None:
    """Add the plank, with a handle for each of two arms."""
    plank = spec.worldbody.add_body(name="plank", pos=(*PLANK_AT_M, PLANK_HALF_M[2]))
    plank.add_freejoint(name="plank")
    plank.add_geom(name="plank", type=_BOX, size=PLANK_HALF_M, mass=_PLANK_KG, material="oak")
    for arm, side in zip(arms, (-1, 1), strict=True):
        add_handle(spec, plank, arm, side)
    add_shadow(spec, "plank", radius_m=0.22)
