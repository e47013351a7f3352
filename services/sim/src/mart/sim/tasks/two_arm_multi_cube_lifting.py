"""Build multi-cube lifting: one cube of 4 cm in front of each arm, in the arm's colour."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from mart.protocol.tasks import Arm, Task
from mart.sim.scene.data import Array, Data, evenly
from mart.sim.scene.gripper import GRASPABLE
from mart.sim.scene.palette import rgba
from mart.sim.scene.scene import Scene, TaskStatus
from mart.sim.scene.shadows import add_shadow
from mart.sim.scene.symbols import add_tile

CUBE_HALF_M = 0.02
CUBE_MASS_KG = 0.1
LIFTED_M = 0.10  # of the cube's underside over the table
FALLEN_Z_M = -0.05


@dataclass(frozen=True)
class Area:
    """Bound where a cube may lie, in its arm's base frame."""

    center_x_m: float
    forward_m: float  # to either side of the centre
    sideways_m: float


# Two hands must not meet: with two arms at the middle of the table, with more between neighbours as well.
_FACING, _AROUND = Area(0.54, 0.08, 0.20), Area(0.47, 0.05, 0.05)


class MultiCubeLifting(Scene):
    """Define the scene of multi-cube lifting."""

    def __init__(self, task: Task) -> None:
        super().__init__(task)
        self._area = _FACING if len(task.arms) == 2 else _AROUND
        self._failures = [f"Cube {index} fell off the table." for index in range(len(task.arms))]

    def add_objects(self, spec: mujoco.MjSpec) -> None:
        for arm in self.task.arms:
            cube = spec.worldbody.add_body(
                name=cube_of(arm.name), pos=(*self._start(arm, 0.0, 0.0), CUBE_HALF_M)
            )
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

    def attach(self, data: Data) -> None:
        bodies = [data.body(cube_of(arm)) for arm in self.task.arm_names]
        self._positions = [body.xpos for body in bodies]
        self._quaternions = [body.xquat for body in bodies]
        rows = evenly(body.id for body in bodies)
        self._heights = data.xpos[..., rows, 2]
        self._upward = data.xmat[..., rows, 6:9]  # each axis's share of up
        self._joints = [data.joint(cube_of(arm)).qpos for arm in self.task.arm_names]

    def place_objects(self, random: np.random.Generator) -> None:
        for arm, joint in zip(self.task.arms, self._joints, strict=True):
            forward = random.uniform(-self._area.forward_m, self._area.forward_m)
            sideways = random.uniform(-self._area.sideways_m, self._area.sideways_m)
            yaw = random.uniform(-np.pi / 4, np.pi / 4)  # every yaw that a cube can have
            position = (*self._start(arm, forward, sideways), CUBE_HALF_M)
            joint[:] = (*position, np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2))

    def observe(self) -> dict[str, Array]:
        observations = {}
        for index, arm in enumerate(self.task.arm_names):
            observations[f"{cube_of(arm)}/position_in_world"] = self._positions[index]
            observations[f"{cube_of(arm)}/quaternion_in_world"] = self._quaternions[index]
        return observations

    def task_status(self) -> TaskStatus:
        lifted, fallen = self._lowest_points_m() > LIFTED_M, self._heights < FALLEN_Z_M
        subtasks = {subtask.name: lifted[..., index] for index, subtask in enumerate(self.task.subtasks)}
        failed = {text: fallen[..., index] for index, text in enumerate(self._failures)}
        return TaskStatus(subtasks, np.logical_and.reduce(lifted, axis=-1), failed)

    def _lowest_points_m(self) -> Array:
        """Return the height of each cube's lowest corner over the table, shape (..., cubes)."""
        return self._heights - CUBE_HALF_M * np.add.reduce(np.abs(self._upward), axis=-1)

    def _start(self, arm: Arm, forward_m: float, sideways_m: float) -> tuple[float, float]:
        x, y, _ = arm.pose_base_in_world.transform_points(
            (self._area.center_x_m + forward_m, sideways_m, 0.0)
        )
        return float(x), float(y)


SCENE = MultiCubeLifting


def cube_of(arm: str) -> str:
    """Return the name of an arm's cube."""
    return arm.replace("arm", "cube")
