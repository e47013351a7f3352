"""Obey the cues of partners: what a script or a policy in a seat does when a person says wait, go or slower. Pure.

`wait` holds the arm until `go`, `thanks` or `come_closer`; `slower` halves its speed until `go`. `let_go` opens a
closed gripper, also of an arm that waits. What an operator makes of `come_closer`, and of `go` where it waited for
nobody's word, is its own: most ignore it. Nothing that was said outlives a reset of the world.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from mart.operators.operator import Operator, SeatView, ToolTarget
from mart.protocol.messages import (
    CUE_COME_CLOSER,
    CUE_GO,
    CUE_LET_GO,
    CUE_SLOWER,
    CUE_THANKS,
    CUE_WAIT,
    Cue,
)
from mart.protocol.pose import Pose, quaternion_conjugate, quaternion_exp, quaternion_log, quaternion_multiply
from mart.protocol.tasks import Limits

SLOW_PACE = 0.5
LET_GO_S = 1.0  # for which a gripper stays open
_HOLDS_FROM = 0.5  # of the gripper: one that is told to close further than this holds something
_STOPS_WITHIN_M, _STOPS_WITHIN_RAD = 0.03, 0.2


@dataclass(frozen=True)
class Obedience:
    """Hold what the cues so far ask of an arm: to wait, to be slow, or neither."""

    waits: bool = False
    slow: bool = False

    def after(self, cue: Cue) -> Obedience:
        """Return what is asked once `cue` has been said, too; the newest word wins."""
        if cue == CUE_WAIT:
            return replace(self, waits=True)
        if cue == CUE_SLOWER:
            return replace(self, slow=True)
        if cue == CUE_GO:
            return Obedience()
        if cue in (CUE_THANKS, CUE_COME_CLOSER):
            return replace(self, waits=False)
        return self

    @property
    def pace(self) -> float:
        """The share of the usual speed: 1, a half, or 0 while it waits."""
        if self.waits:
            return 0.0
        return SLOW_PACE if self.slow else 1.0


class ObedientOperator(Operator):
    """Make any operator obey its partners' cues, whatever it knows of them.

    While it waits it is not asked, and its arms hold still. While it is slow, its arms go half as far in a tick. At
    `let_go` the closed grippers open for a second, in which the arms hold still.

    >>> drive_seats(ObedientOperator(Riser()), room="room-1")  # doctest: +SKIP
    """

    _obedience: Obedience
    _lets_go: bool  # asked since the last act
    _open_until_s: float
    _said: Mapping[str, ToolTarget]  # by the operator, when it was last asked
    _held: Mapping[str, ToolTarget]  # what holds the arms still; empty while they go on

    def __init__(self, operator: Operator) -> None:
        self._operator = operator
        self._forget()

    def prepare(self) -> None:
        """Hand on; see `Operator.prepare`."""
        self._operator.prepare()

    def begin(self, episode: int) -> None:
        """Forget every cue, and hand on; see `Operator.begin`."""
        self._forget()
        self._operator.begin(episode)

    def on_cue(self, cue: Cue, arm: str) -> None:
        """Obey from the next `act` on, and hand on; see `Operator.on_cue`."""
        self._obedience = self._obedience.after(cue)
        self._lets_go = self._lets_go or cue == CUE_LET_GO
        self._operator.on_cue(cue, arm)

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        """Return the operator's targets as the cues allow them; see `Operator.act`."""
        if self._lets_go:
            self._lets_go = False
            self._let_go(view)
        if self._obedience.waits or view.sim_time_s < self._open_until_s:
            self._held = self._held or self._hold(view)
            return self._held
        self._held = {}
        self._said = self._operator.act(view)
        if self._obedience.pace == 1.0:
            return self._said
        return {
            arm: replace(
                target,
                pose_tool_in_base=slowed(measured, target.pose_tool_in_base, view.task.arm(arm).kind.limits),
            )
            for arm, measured in view.poses_tool_in_base.items()
            if (target := self._said.get(arm)) is not None
        }

    def _let_go(self, view: SeatView) -> None:
        self._held = self._held or self._hold(view)
        closed = {arm for arm, target in self._held.items() if is_closed(target)}
        if closed:
            self._open_until_s = view.sim_time_s + LET_GO_S
            self._held = {
                arm: replace(target, gripper=0.0) if arm in closed else target
                for arm, target in self._held.items()
            }

    def _hold(self, view: SeatView) -> dict[str, ToolTarget]:
        return {arm: held(self._said.get(arm), pose) for arm, pose in view.poses_tool_in_base.items()}

    def _forget(self) -> None:
        self._obedience = Obedience()
        self._lets_go = False
        self._open_until_s = 0.0
        self._said = {}
        self._held = {}


def is_closed(target: ToolTarget | None) -> bool:
    """Whether a target closes the gripper on something."""
    return target is not None and target.gripper > _HOLDS_FROM


def held(target: ToolTarget | None, measured_pose_tool_in_base: Pose) -> ToolTarget:
    """Return the target of an arm that stops now, with the gripper and the clutch let go of as they are.

    A target near the tool stays: it carries the load. One further off would draw the arm on, so the tool's place holds.
    """
    if target is None:
        return ToolTarget(measured_pose_tool_in_base, 0.0, engaged=False)
    way_m, way_rad = target.pose_tool_in_base.distance_to(measured_pose_tool_in_base)
    near = way_m < _STOPS_WITHIN_M and way_rad < _STOPS_WITHIN_RAD
    pose = target.pose_tool_in_base if near else measured_pose_tool_in_base
    return ToolTarget(pose, target.gripper, engaged=False)


def slowed(measured: Pose, goal: Pose, limits: Limits) -> Pose:
    """Return the pose half as far from the measured one as a tick would lead the tool towards `goal`."""
    shift = np.clip(goal.position - measured.position, -limits.step_m, limits.step_m)
    turn = quaternion_log(
        quaternion_multiply(goal.quaternion_wxyz, quaternion_conjugate(measured.quaternion_wxyz))
    )
    turn = np.clip(turn, -limits.step_rad, limits.step_rad)
    return Pose(
        measured.position + SLOW_PACE * shift,
        quaternion_multiply(quaternion_exp(SLOW_PACE * turn), measured.quaternion_wxyz),
    )
