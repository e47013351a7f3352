"""Plan the assembly: put the own column into its socket, then carry the tabletop with the partner, each by a knob.

The two agree by what they see: who has come to the own knob waits until the partner's tool rests at the other one, and
whoever is ahead on the way waits for the other.
"""

from __future__ import annotations

import math

import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.perception import (
    ObservedPose,
    StillnessDetector,
    across,
    apart_m,
    at,
    seen,
    seen_tool,
    standing,
    uprightness,
)
from mart.sim.experts.pick_and_place import PickAndPlace
from mart.sim.experts.plan import (
    CLOSED,
    OPEN,
    ExpertPlan,
    OperatorObservation,
    PlanStep,
    Until,
    Waypoint,
    go,
    wait,
)

_SOCKET_X_M, _KNOB_X_M = 0.12, 0.205
_SEATED_Z_M, _TOP_SEATED_Z_M = 0.01, 0.16  # over the base
_NECK = at(0.0, 0.0, 0.117)  # where a column is gripped: it hangs from there
_LOOKED_AT = at(
    0.0, 0.0, 0.03
)  # on a column that is brought to its socket: low, but not so low as to swing much
_AXIS_AS_X = Pose(np.zeros(3), np.array([0.5**0.5, 0.0, -(0.5**0.5), 0.0]))
_LYING, _LEANING, _STAND_UP_M = 0.7, 0.96, 0.16
_OVER_SOCKET_M, _OVER_PEGS_M = 0.06, 0.05
_PRESS_M = 0.004
_SEEN_SEATED_M = 0.012

_AHEAD_M = 0.010
_PACE = 0.7  # of carrying together
_LIFTED_M = 0.03
_PARTNER_M = 0.045  # a partner whose tool stays this near to its knob has gripped it
_STILL_M, _STILL_S = 0.015, 0.5
_PATIENCE_S = 8.0


def plan(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    """Yield the waypoints of one arm."""
    column, top = _Column(arm, human), _Tabletop(arm, human)
    while True:
        while not column.is_seated(obs):
            obs = yield from column.place(obs)
        while not top.is_seated(obs):
            obs = yield from top.mount(obs)
        obs = yield Waypoint(obs.pose_tool_in_base, OPEN, pace=0.0)


class _Column:
    def __init__(self, arm: Arm, human: HumanErrorModel) -> None:
        self._base, self._column = seen(arm, "table_base"), seen(arm, arm.name.replace("arm", "column"))
        self._seat = at(_side(arm) * _SOCKET_X_M, 0.0, _SEATED_Z_M)
        self._grip = PickAndPlace(
            human, lambda now: across(self._column(now) @ _LOOKED_AT, math.tau), self._tool, hangs=True
        )

    def is_seated(self, now: OperatorObservation) -> bool:
        column = self._column(now)
        return apart_m(column, self._place(now)) < _SEEN_SEATED_M and uprightness(column) > 0.985

    def place(self, obs: OperatorObservation) -> PlanStep:
        """Try once to put the own column into its socket."""
        lies = self._lies(obs)
        obs = yield from self._grip.pick(obs)
        if lies:
            up = Waypoint(at(0.0, 0.0, _STAND_UP_M) @ obs.pose_tool_in_base, CLOSED)
            obs = yield from go(obs, lambda _: up, patience_s=3.0)
        return (
            yield from self._grip.put(
                obs, self._place_looked_at, _OVER_SOCKET_M, self.is_seated, caught=self._leans
            )
        )

    def _leans(self, now: OperatorObservation) -> bool:
        """Whether the column leans more than it does when it hangs freely."""
        return uprightness(self._column(now)) < _LEANING

    def _lies(self, now: OperatorObservation) -> bool:
        return uprightness(self._column(now)) < _LYING

    def _neck(self, now: OperatorObservation) -> Pose:
        return self._column(now) @ _NECK

    def _tool(self, now: OperatorObservation) -> Pose:
        """Return the tool with the fingers across a column that lies, so that it swings upright between them."""
        neck = self._neck(now)
        return across(neck @ _AXIS_AS_X) if self._lies(now) else across(neck, math.pi / 2)

    def _place(self, now: OperatorObservation) -> Pose:
        return standing(self._base(now) @ self._seat, self._column(now), math.pi / 2)

    def _place_looked_at(self, now: OperatorObservation) -> Pose:
        return self._place(now) @ _LOOKED_AT


class _Tabletop:
    def __init__(self, arm: Arm, human: HumanErrorModel) -> None:
        self._human = human
        self._base, self._top = seen(arm, "table_base"), seen(arm, "tabletop")
        self._partner = seen_tool(arm, "arm1" if arm.name == "arm0" else "arm0")
        self._own, self._other = (at(side * _KNOB_X_M, 0.0, 0.0) for side in (_side(arm), -_side(arm)))
        self._grip = PickAndPlace(human, self._knob, self._knob, hangs=True)

    def is_seated(self, now: OperatorObservation) -> bool:
        top = self._top(now)
        return apart_m(top, self._place(now)) < _SEEN_SEATED_M and uprightness(top) > 0.995

    def mount(self, obs: OperatorObservation) -> PlanStep:
        """Try once: grip the own knob, then up, over the pegs and down together."""
        obs = yield from self._grip.pick(obs)
        here, still = (
            Waypoint(obs.pose_tool_in_base, CLOSED),
            StillnessDetector(self._partner, _STILL_M, _STILL_S),
        )
        obs = yield from wait(
            obs,
            here,
            self._human,
            lambda now: (
                (still(now) and self._is_gripped_by_partner(now))
                or self._grip.is_lost(now)
                or self.is_seated(now)
            ),
        )
        if not self.is_seated(obs):
            up = self._raised(obs)
            obs = yield from self._carry(
                obs, lambda _: up, lambda now: apart_m(self._top(now), up) < _LIFTED_M
            )
        while not (self.is_seated(obs) or self._grip.is_lost(obs)):
            obs = yield from self._carry(obs, self._over_pegs, self._is_over_pegs)
            obs = yield from self._carry(
                obs, lambda now: at(0.0, 0.0, -_PRESS_M) @ self._place(now), self.is_seated
            )
        return (yield from self._grip.let_go(obs))

    def _carry(self, obs: OperatorObservation, goal: ObservedPose, until: Until) -> PlanStep:
        """Bring the tabletop to its goal by the own knob, waiting while the own end is ahead of the other."""

        def pace(now: OperatorObservation) -> float:
            top, end = self._top(now), goal(now)
            own_left_m, other_left_m = (apart_m(top @ knob, end @ knob) for knob in (self._own, self._other))
            return 0.0 if own_left_m < other_left_m - _AHEAD_M else _PACE

        def knob_goal(now: OperatorObservation) -> Pose:
            return across(goal(now) @ self._own)

        return (yield from self._grip.bring(obs, knob_goal, until, pace=pace, patience_s=_PATIENCE_S))

    def _knob(self, now: OperatorObservation) -> Pose:
        """Find the knob with the tool that grips it: round as it is, that need not lean when the tabletop does."""
        return across(self._top(now) @ self._own)

    def _place(self, now: OperatorObservation) -> Pose:
        return standing(self._base(now) @ at(0.0, 0.0, _TOP_SEATED_Z_M), self._top(now), math.tau)

    def _over_pegs(self, now: OperatorObservation) -> Pose:
        return at(0.0, 0.0, _OVER_PEGS_M) @ self._place(now)

    def _is_over_pegs(self, now: OperatorObservation) -> bool:
        return self._grip.is_over(now, lambda now: across(self._place(now) @ self._own))

    def _raised(self, now: OperatorObservation) -> Pose:
        """Return the tabletop's place, but level and as high as over the pegs."""
        top = self._top(now)
        place = np.array([*top.position[:2], self._over_pegs(now).position[2]])
        return standing(Pose(place, top.quaternion_wxyz), top, math.tau)

    def _is_gripped_by_partner(self, now: OperatorObservation) -> bool:
        return apart_m(self._top(now) @ self._other, self._partner(now)) < _PARTNER_M


def _side(arm: Arm) -> float:
    return -1.0 if arm.name == "arm0" else 1.0
