"""Which plan belongs to which task."""

from __future__ import annotations

from collections.abc import Callable

from mart.protocol.tasks import Arm, Task
from mart.sim.experts.person import Person
from mart.sim.experts.plan import Plan, Sight
from mart.sim.experts.two_arm_multi_cube_lifting import lift_cube

PlanOf = Callable[[Arm, Person, Sight], Plan]

_PLANS: dict[str, PlanOf] = {"two_arm_multi_cube_lifting": lift_cube}


def plan_of(task: Task) -> PlanOf:
    return _PLANS[task.name]
