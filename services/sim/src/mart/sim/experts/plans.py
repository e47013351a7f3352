"""Which plan belongs to which task."""

from __future__ import annotations

from collections.abc import Callable

from mart.protocol.tasks import Arm, Task
from mart.sim.experts.person import Person
from mart.sim.experts.plan import Plan, Sight
from mart.sim.experts.three_arm_lift_wiping import lift_and_wipe
from mart.sim.experts.two_arm_drink_tray_lifting import lift_tray
from mart.sim.experts.two_arm_multi_cube_lifting import lift_cube

PlanOf = Callable[[Arm, Person, Sight], Plan]

_PLANS: dict[str, PlanOf] = {
    "two_arm_multi_cube_lifting": lift_cube,
    "two_arm_drink_tray_lifting": lift_tray,
    "three_arm_lift_wiping": lift_and_wipe,
}


def plan_of(task: Task) -> PlanOf:
    return _PLANS[task.name]
