"""Find the plan of a task by the task's name; that of somebody's own task beside its task file."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import Arm, Task
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.plan import ExpertPlan, OperatorObservation

PlanOf = Callable[[Arm, HumanErrorModel, OperatorObservation], ExpertPlan]


def plan_of(task: Task) -> PlanOf:
    """Return `plan` of the file `<task.name>.py` beside this one, or beside the task file of somebody's own task.

    Raises NotFound for a task that no script can do, InvalidInput for a file that cannot be used.
    """
    if task.file is not None:
        if task.file.plan_path is None:
            raise NotFound(
                f"No script can do {task.title}: take the seats yourselves, or write {task.name}.py beside its file."
            )
        return _plan_in(task.file.plan_path, task.file.plan_path.stat().st_mtime_ns)
    name = f"{__package__}.{task.name}"
    if find_spec(name) is None:
        raise NotFound(
            f"No script can do {task.title}: take the seats yourselves, or write {task.name}.py among the experts."
        )
    plan: PlanOf = import_module(name).plan
    return plan


@lru_cache(maxsize=64)
def _plan_in(path: Path, _modified_ns: int) -> PlanOf:
    """Run somebody's Python file, which lies where whoever started this process says."""
    spec = spec_from_file_location(f"{__package__}.own.{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
        plan: PlanOf = module.plan
    except Exception as error:
        raise InvalidInput(f"{path} cannot be used as a plan: {type(error).__name__}: {error}.") from error
    return plan
