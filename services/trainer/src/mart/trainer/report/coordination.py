"""Table I: what each kind of subtask costs the operators' success, from what the episode files say.

The paper (section "System Analysis"): an episode passes through stages, and the marginal degradation of a stage is the
best success rate that it could have had (100 % for the first, the rate of the stage before for the others) less the one
that it had. That is the share of all episodes that got as far as this stage and no further. Whoever has passed the last
stage has succeeded (a tray that was up and then tipped over has not), so the degradations and the success rate add up
to 100 %.

Stages are the task catalogue's subtasks in order, neighbours of the same kind taken together: Table Assembly is
uncoordinated and then coordinated, Lift Wiping the other way round.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from mart.protocol.tasks import Task
from mart.trainer.evaluate.statistics import Rate


@dataclass(frozen=True)
class Attempt:
    """What was reached in one episode. done: names of the subtasks that were done at any time."""

    done: frozenset[str]
    success: bool


@dataclass(frozen=True)
class CoordinationStage:
    """Neighbouring subtasks of one kind.

    entered, passed: how many episodes began and completed it, all stages before included.
    """

    subtasks: tuple[str, ...]
    coordinated: bool
    entered: int
    passed: int


@dataclass(frozen=True)
class Coordination:
    """How the attempts at one task passed its stages."""

    task: str
    stages: tuple[CoordinationStage, ...]
    episodes: int
    successes: int

    def degradation(self, *, coordinated: bool) -> Rate | None:
        """Episodes lost in all stages of one kind, of all episodes; None where the task has no such stage."""
        stages = [stage for stage in self.stages if stage.coordinated is coordinated]
        if not stages:
            return None
        return Rate(sum(stage.entered - stage.passed for stage in stages), self.episodes)


def coordination(task: Task, attempts: Sequence[Attempt]) -> Coordination:
    """Count how many attempts entered and passed each stage of a task."""
    kinds = groupby(task.subtasks, lambda subtask: subtask.coordinated)
    planned = [(coordinated, tuple(subtask.name for subtask in group)) for coordinated, group in kinds]
    stages: list[CoordinationStage] = []
    left: Sequence[Attempt] = attempts
    for number, (coordinated, names) in enumerate(planned, start=1):
        passed = [attempt for attempt in left if attempt.done.issuperset(names)]
        if number == len(planned):
            passed = [attempt for attempt in passed if attempt.success]
        stages.append(CoordinationStage(names, coordinated, len(left), len(passed)))
        left = passed
    return Coordination(task.name, tuple(stages), len(attempts), sum(attempt.success for attempt in attempts))
