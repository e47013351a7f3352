"""Find the plan of a task by the task's name."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec

from mart.protocol.errors import NotFound
from mart.protocol.tasks import Arm, Task
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.plan import ExpertPlan, OperatorObservation

PlanOf = Callable[[Arm, HumanErrorModel, OperatorObservation], ExpertPlan]


def plan_of(task: Task) -> PlanOf:
    """Return `plan` of the file `<task.name>.py` beside this one; raises NotFound for a task that no script can do."""
    name = f"{__package__}.{task.name}"
    if find_spec(name) is None:
        raise NotFound(
            f"No script can do {task.title}: take the seats yourselves, or write {task.name}.py among the experts."
        )
    plan: PlanOf = import_module(name).plan
    return plan
