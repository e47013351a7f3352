"""Multi-cube lifting: one cube of 4 cm in front of each arm, in the arm's colour."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.tasks import Arm
from mart.sim.tasks.scene import Judgement, Scene
from mart.sim.world.gripper import GRASPABLE
from mart.sim.world.palette import rgba
from mart.sim.world.shadows import add_shadow
from mart.sim.world.symbols import add_tile

CUBE_HALF_M = 0.02
CUBE_MASS_KG = 0.1
LIFTED_M = 0.10  # of the cube's underside over the table
FALLEN_Z_M = -0.05

# Around the point 0.54 m in front of the base: nearer to the middle of the table than 10 cm, two hands would meet.
_CENTER_IN_BASE = (0.54, 0.0)
_SPREAD_FORWARD_M, _SPREAD_SIDEWAYS_M = 0.08, 0.20


class MultiCubeLifting(Scene):
    def add_objects(self, spec: mujoco.MjSpec) -> None:
        for arm in self.task.arms:
            cube = spec.worldbody.add_body(name=cube_of(arm.name), pos=(*_start(arm, 0.0, 0.0), CUBE_HALF_M))
            cube.add_freejoint(name=cube_of(arm.name))
            cube.add_geom(
                name=cube_of(arm.name),
                type=mujoco.mjtGeom.mjGEOM_BOX,
                size=(CUBE_HALF_M,) * 3,
                mass=CUBE_MASS_KG,
                rgba=rgba(arm.color),
                material="paint",
                **GRASPABLE,
            )
            for normal in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)):
                x, y, z = (CUBE_HALF_M * axis for axis in normal)
                add_tile(spec, cube, arm.symbol, radius_m=0.009, position=(x, y, z), normal=normal)
            add_shadow(spec, cube_of(arm.name), radius_m=0.05)

    def place_objects(self, model: mujoco.MjModel, data: mujoco.MjData, random: np.random.Generator) -> None:
        for arm in self.task.arms:
            forward = random.uniform(-_SPREAD_FORWARD_M, _SPREAD_FORWARD_M)
            sideways = random.uniform(-_SPREAD_SIDEWAYS_M, _SPREAD_SIDEWAYS_M)
            yaw = random.uniform(-np.pi / 4, np.pi / 4)  # every yaw that a cube can have
            data.joint(cube_of(arm.name)).qpos = (
                *_start(arm, forward, sideways), CUBE_HALF_M, np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)
            )  # fmt: skip

    def observe(self, model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, NDArray[np.float64]]:
        observations = {}
        for arm in self.task.arms:
            cube = cube_of(arm.name)
            observations[f"{cube}/position_in_world"] = data.body(cube).xpos.copy()
            observations[f"{cube}/quaternion_in_world"] = data.body(cube).xquat.copy()
        return observations

    def judge(self, model: mujoco.MjModel, data: mujoco.MjData) -> Judgement:
        lifted, failed = {}, None
        for arm in self.task.arms:
            cube = cube_of(arm.name)
            lifted[f"lift_{cube}"] = lowest_point_m(data, cube) > LIFTED_M
            if data.body(cube).xpos[2] < FALLEN_Z_M:
                failed = f"Cube {cube.removeprefix('cube')} fell off the table."
        return Judgement(lifted, all(lifted.values()), failed)


def cube_of(arm: str) -> str:
    return arm.replace("arm", "cube")


def lowest_point_m(data: mujoco.MjData, cube: str) -> float:
    """Height of the cube's lowest corner over the table."""
    body = data.body(cube)
    return float(body.xpos[2] - CUBE_HALF_M * np.abs(body.xmat[6:9]).sum())


def _start(arm: Arm, forward_m: float, sideways_m: float) -> tuple[float, float]:
    x, y, _ = arm.pose_base_in_world.transform_points(
        (_CENTER_IN_BASE[0] + forward_m, _CENTER_IN_BASE[1] + sideways_m, 0.0)
    )
    return float(x), float(y)
