"""What an emulated person says to assistants: a press, some moments after the person knows why."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from mart.operators import SeatView, ToolTarget
from mart.operators.obedience import is_closed
from mart.protocol.messages import CUE_COME_CLOSER, CUE_GO, CUE_LET_GO, CUE_WAIT, Cue
from mart.protocol.pose import Pose
from mart.protocol.tasks import Task

_PRESS_S = 0.25  # of a finger to its key, and of the key to the assistant
_GRIPS_S = 0.6  # fingers that were told to close have closed
_OFFERED_Z_M = 0.16  # a hammer that high is in somebody's hand
_IN_HAND_M = 0.13  # from a tool to the middle of a hammer that it holds
_COMING_M = 0.20  # a partner this near to it needs no word

Words = Callable[[SeatView, ToolTarget], Cue | None]


class EmulatedVoice:
    """Give one person's cues as late as the person notices and presses."""

    def __init__(self, task: Task, arm: str, notice_s: float) -> None:
        self._words = words_of(task, arm)
        self._late_s = notice_s + _PRESS_S
        self._said: deque[tuple[float, Cue]] = deque()
        self.count = 0

    def due(self, view: SeatView, target: ToolTarget) -> Sequence[Cue]:
        """Return what is heard now; to be asked at every tick with what the person sees and does."""
        cue = self._words(view, target)
        if cue is not None:
            self._said.append((view.sim_time_s + self._late_s, cue))
        due = []
        while self._said and self._said[0][0] <= view.sim_time_s:
            due.append(self._said.popleft()[1])
        self.count += len(due)
        return due


def words_of(task: Task, arm: str) -> Words:
    """Return what a person at this arm of this task has to say."""
    seen = {one.name for one in task.observations_of(arm)}
    if "hammer/position_in_world" in seen:
        return OfferingWords(task, arm) if arm == task.arm_names[0] else ReceivingWords(task, arm)
    carries = any(one.name == f"handle{arm[-1]}/position_in_world" for one in task.observations)
    return CarryingWords() if carries else lambda view, target: None


class CarryingWords:
    """Say wait when the handle is out of the hand, and go when it is in it again."""

    def __init__(self) -> None:
        self._closed_s: float | None = None  # since when the hand is closed
        self._waited_for = False

    def __call__(self, view: SeatView, target: ToolTarget) -> Cue | None:
        if not is_closed(target):
            lost, self._closed_s = self._closed_s is not None, None
            if lost and not self._waited_for:
                self._waited_for = True
                return CUE_WAIT
            return None
        self._closed_s = view.sim_time_s if self._closed_s is None else self._closed_s
        if self._waited_for and view.sim_time_s - self._closed_s > _GRIPS_S:
            self._waited_for = False
            return CUE_GO
        return None


class OfferingWords:
    """Say come closer once the hammer hangs in the own hand and the partner is not there."""

    def __init__(self, task: Task, arm: str) -> None:
        self._see = _HammerView(task, arm)
        self._said = False

    def __call__(self, view: SeatView, target: ToolTarget) -> Cue | None:
        offers = is_closed(target) and self._see.held_out(view)
        self._said = self._said and offers
        if not offers or self._said or self._see.partner_away_m(view) < _COMING_M:
            return None
        self._said = True
        return CUE_COME_CLOSER


class ReceivingWords:
    """Say let go once the hammer that the partner holds out is in the own hand, too."""

    def __init__(self, task: Task, arm: str) -> None:
        self._see = _HammerView(task, arm)
        self._gripped_s: float | None = None
        self._said = False

    def __call__(self, view: SeatView, target: ToolTarget) -> Cue | None:
        if not (
            is_closed(target) and self._see.held_out(view) and self._see.partner_away_m(view) < _IN_HAND_M
        ):
            self._gripped_s, self._said = None, False
            return None
        self._gripped_s = view.sim_time_s if self._gripped_s is None else self._gripped_s
        if self._said or view.sim_time_s - self._gripped_s < _GRIPS_S:
            return None
        self._said = True
        return CUE_LET_GO


class _HammerView:
    """Find the hammer, the own tool and the partner's in the world."""

    def __init__(self, task: Task, arm: str) -> None:
        self._base: Pose = task.arm(arm).pose_base_in_world
        self._arm, (self._partner,) = arm, (other for other in task.arm_names if other != arm)

    def held_out(self, view: SeatView) -> bool:
        """Whether the hammer is up, in the own hand or near it."""
        hammer = view.observations["hammer/position_in_world"]
        tool: NDArray[np.float64] = self._base.transform_points(view.poses_tool_in_base[self._arm].position)
        return bool(hammer[2] > _OFFERED_Z_M and np.linalg.norm(hammer - tool) < _IN_HAND_M)

    def partner_away_m(self, view: SeatView) -> float:
        """Return how far the partner's tool is from the hammer."""
        partner = view.observations[f"{self._partner}/tool_position_in_world"]
        return float(np.linalg.norm(view.observations["hammer/position_in_world"] - partner))
