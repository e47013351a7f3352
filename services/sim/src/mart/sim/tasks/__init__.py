"""One file per task: geometry, resets, observations, success."""

from __future__ import annotations

from mart.protocol.tasks import Task
from mart.sim.tasks.scene import Judgement, Scene
from mart.sim.tasks.three_arm_lift_wiping import LiftWiping
from mart.sim.tasks.two_arm_drink_tray_lifting import DrinkTrayLifting
from mart.sim.tasks.two_arm_multi_cube_lifting import MultiCubeLifting
from mart.sim.tasks.two_arm_pick_place_handover import PickPlaceHandover
from mart.sim.tasks.two_arm_table_assembly import TableAssembly

__all__ = ["Judgement", "Scene", "scene_of"]

_SCENES: dict[str, type[Scene]] = {
    "two_arm_multi_cube_lifting": MultiCubeLifting,
    "two_arm_drink_tray_lifting": DrinkTrayLifting,
    "two_arm_table_assembly": TableAssembly,
    "two_arm_pick_place_handover": PickPlaceHandover,
    "three_arm_lift_wiping": LiftWiping,
}


def scene_of(task: Task) -> Scene:
    return _SCENES[task.name](task)
