"""Which plan belongs to which task."""

from __future__ import annotations

from collections.abc import Callable

from mart.protocol.tasks import Arm, Task
from mart.sim.experts.person import Person
from mart.sim.experts.plan import Plan, Sight
from mart.sim.experts.three_arm_lift_wiping import lift_and_wipe
from mart.sim.experts.two_arm_drink_tray_lifting import lift_tray
from mart.sim.experts.two_arm_multi_cube_lifting import lift_cube
from mart.sim.experts.two_arm_pick_place_handover import hand_over
from mart.sim.experts.two_arm_table_assembly import assemble_table

PlanOf = Callable[[Arm, Person, Sight], Plan]

_PLANS: dict[str, PlanOf] = {
    "two_arm_multi_cube_lifting": lift_cube,
    "two_arm_drink_tray_lifting": lift_tray,
    "two_arm_table_assembly": assemble_table,
    "two_arm_pick_place_handover": hand_over,
    "three_arm_lift_wiping": lift_and_wipe,
}


def plan_of(task: Task) -> PlanOf:
    return _PLANS[task.name]
