"""Build drink tray lifting: a tray with four drinks between two arms."""

from __future__ import annotations

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.sim.scene.data import Array, Data
from mart.sim.scene.scene import Scene, TaskStatus, any_of
from mart.sim.tasks.tray import Tray, across, add_tray

LIFTED_M = 0.10  # of the tray's lowest corner over the table
_SPREAD_M, _SPREAD_RAD = 0.06, 0.25


class DrinkTrayLifting(Scene):
    """Define the scene of drink tray lifting."""

    def add_objects(self, spec: mujoco.MjSpec) -> None:
        add_tray(spec, self.task.arms)

    def attach(self, data: Data) -> None:
        self._tray = Tray(data, self.task.arms)

    def place_objects(self, random: np.random.Generator) -> None:
        x, y = random.uniform(-_SPREAD_M, _SPREAD_M, 2)
        self._tray.place(x, y, random.uniform(-_SPREAD_RAD, _SPREAD_RAD), random)

    def start_pose_in_base(self, arm: Arm, random: np.random.Generator) -> Pose:
        return across(super().start_pose_in_base(arm, random))

    def observe(self) -> dict[str, Array]:
        return self._tray.observe()

    def task_status(self) -> TaskStatus:
        spills = self._tray.spills()
        lifted = (self._tray.lowest_point_m() > LIFTED_M) & ~any_of(spills.values())
        return TaskStatus({"lift_tray": lifted}, lifted, spills)


SCENE = DrinkTrayLifting
