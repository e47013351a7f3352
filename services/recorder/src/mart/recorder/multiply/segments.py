"""Cut each arm's way where something happened that the file tells of: its gripper, the subtasks. Pure.

Nobody marks anything by hand. An arm's segment ends where its gripper opens or closes, where a subtask of its own is
done, and where one that takes several arms is. From the tick at which an arm has done what it does alone, it is one of
those that work together: their ways keep the time they had (`together_from`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mart.protocol.tasks import Subtask, Task
from mart.recorder.multiply.demonstration import Demonstration

CLOSES, OPENS, DONE, ENDS = "closes", "opens", "done", "ends"
_SHORTEST = 3  # ticks


@dataclass(frozen=True)
class SegmentKind:
    """Say what segments of several demonstrations have in common.

    arms: whose; of several arms that carry together. closed: the gripper during it. end: closes, opens, done or ends.
    step: the arm's first subtask that is not done yet; "" after the last.
    """

    arms: tuple[str, ...]
    closed: bool
    end: str
    step: str


@dataclass(frozen=True)
class Segment:
    """Mark the ticks of an arm's way from `begin` to before `end`."""

    arm: str
    begin: int
    end: int
    kind: SegmentKind


def acting(subtask: Subtask) -> tuple[str, ...]:
    """Return the arms that a subtask takes."""
    return subtask.arms or tuple(subtask.to_do)


def together(task: Task) -> tuple[str, ...]:
    """Return the arms that some subtask takes at the same time."""
    taken = {arm for one in task.subtasks if one.coordinated for arm in acting(one)}
    return tuple(arm for arm in task.arm_names if arm in taken)


def together_from(task: Task, demonstration: Demonstration, arm: str) -> int:
    """Return the tick from which an arm works with others: once the subtasks before, which it does alone, are done.

    For an arm that never does it is the number of ticks.
    """
    if arm not in together(task):
        return demonstration.ticks
    alone = []
    for subtask in task.subtasks:
        if arm in acting(subtask):
            if subtask.coordinated:
                break
            alone.append(first_done(demonstration, subtask.name))
    return min(max(alone, default=0), demonstration.ticks)


def first_done(demonstration: Demonstration, subtask: str) -> int:
    """Return the first tick at which a subtask was done; the number of ticks where it never was."""
    done = demonstration.subtasks.get(subtask)
    return demonstration.ticks if done is None or not done.any() else int(np.argmax(done))


def segments_of(task: Task, demonstration: Demonstration, arm: str) -> tuple[Segment, ...]:
    """Cut an arm's way into segments; they follow on one another and cover all of it."""
    closed = demonstration.ways[arm].closed
    ticks = demonstration.ticks
    cuts: dict[int, str] = {}
    for subtask in task.subtasks:
        if subtask.coordinated or arm in acting(subtask):
            cuts[first_done(demonstration, subtask.name)] = DONE
    joins = together_from(task, demonstration, arm)
    cuts[joins] = DONE
    for change in np.flatnonzero(closed[1:] != closed[:-1]) + 1:
        cuts[int(change)] = CLOSES if closed[change] else OPENS
    cuts[ticks] = ENDS
    found, begin = [], 0
    for tick in sorted(cuts):
        if tick - begin >= _SHORTEST or (tick in (joins, ticks) and tick > begin):
            kind = _kind(task, demonstration, arm, (begin + tick) // 2, cuts[tick])
            found.append(Segment(arm, begin, tick, kind))
            begin = tick
    return tuple(found)


def _kind(task: Task, demonstration: Demonstration, arm: str, middle: int, end: str) -> SegmentKind:
    """Return the kind of the segment that has this tick in its middle and ends so."""
    step = next_step(task, arm, {name: bool(done[middle]) for name, done in demonstration.subtasks.items()})
    closed = bool(demonstration.ways[arm].closed[middle])
    began = _closed_from(demonstration, arm, middle) >= together_from(task, demonstration, arm)
    joined = step is not None and step.coordinated and closed and began and len(acting(step)) > 1
    arms = acting(step) if joined and step is not None else (arm,)
    return SegmentKind(arms, closed, end, step.name if step else "")


def _closed_from(demonstration: Demonstration, arm: str, tick: int) -> int:
    """Return the tick from which the gripper has been as it is at this one: what it holds it has held since."""
    closed = demonstration.ways[arm].closed[: tick + 1]
    changes = np.flatnonzero(closed[1:] != closed[:-1]).tolist()
    return int(changes[-1]) + 1 if changes else 0


def next_step(task: Task, arm: str, done: Mapping[str, bool]) -> Subtask | None:
    """Return the first subtask of an arm that is not done; None after the last."""
    own = (one for one in task.subtasks if arm in acting(one) and not done.get(one.name, False))
    return next(own, None)
