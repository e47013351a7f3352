"""Carry a tray by its two handles: one arm's part, in step with a partner whom it only sees."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.protocol.tasks.tray import handle_of, partner_of
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.perception import apart_m, seen, seen_tool, upright
from mart.sim.experts.plan import CLOSED, OPEN, OperatorObservation, PlanStep, Waypoint, go, pick, stay, wait

_AWAY_M = 0.05  # a tool further than this from a handle does not hold it
_MISSED = 0.92  # of the gripper: fingers that have closed on nothing
_LEAD_M = 0.04  # how far one goes before seeing the partner follow
_PACE = 0.8
_CLEAR_M = 0.12
_PATIENCE_S = 2.0

Vector = NDArray[np.float64]


class Carrier:
    """Carry the own side of a tray; all poses are in the arm's own base frame."""

    def __init__(self, arm: Arm, human: HumanErrorModel) -> None:
        self._human = human
        partner = partner_of(arm.name)
        self._handle, self._partner_handle = (
            seen(arm, handle_of(arm.name)),
            seen(arm, handle_of(partner)),
        )
        self._partner_tool = seen_tool(arm, partner)

    def pick(self, obs: OperatorObservation) -> PlanStep:
        """Try to grip the own handle until it is in the hand."""
        while True:
            obs = yield from pick(obs, self._human, self._grip)
            if not self.has_lost(obs):
                return obs
            obs = yield from self._let_go(obs)

    def await_partner(self, obs: OperatorObservation) -> PlanStep:
        """Wait until the partner's tool has come to its handle, and a moment longer: fingers close slowly."""
        here = Waypoint(obs.pose_tool_in_base, CLOSED)
        obs = yield from wait(obs, here, self._human, lambda now: not self.is_alone(now))
        return (yield from stay(obs, here, self._human.grips_s()))

    def along(
        self, obs: OperatorObservation, shift: Vector, until: Callable[[OperatorObservation], bool]
    ) -> PlanStep:
        """Move the own handle by `shift` (metres), never far ahead of the partner's.

        Ends when `until` holds or the handle is lost. Where the partner lets go, it goes back to where it began.
        """
        tool = obs.pose_tool_in_base
        way_m = float(np.linalg.norm(shift))
        forward = shift / way_m
        # The partner is to come as far as this arm, from beside it: level with it, whatever the tray is now.
        beside = (self._partner_handle(obs).position - self._handle(obs).position) * (1, 1, 0)
        partner_start = self._handle(obs).position + beside
        while not (until(obs) or self.has_lost(obs)):
            followed_m = float((self._partner_handle(obs).position - partner_start) @ forward)
            lead_m = 0.0 if self.is_alone(obs) else _LEAD_M
            done_m = min(max(followed_m + lead_m, 0.0), way_m)
            goal = Pose(tool.position + done_m * forward, tool.quaternion_wxyz)
            obs = yield Waypoint(goal, CLOSED, _PACE)
        return obs

    def has_lost(self, now: OperatorObservation) -> bool:
        """Whether the own handle is not in the hand."""
        return apart_m(self._handle(now), now.pose_tool_in_base) > _AWAY_M or now.gripper > _MISSED

    def is_alone(self, now: OperatorObservation) -> bool:
        """Whether the partner's tool is away from its handle."""
        return apart_m(self._partner_handle(now), self._partner_tool(now)) > _AWAY_M

    def _let_go(self, obs: OperatorObservation) -> PlanStep:
        """Open and go up, so as to take the tray with it as little as can be."""
        here = obs.pose_tool_in_base
        obs = yield from stay(obs, Waypoint(here, OPEN), self._human.settles_s())
        up = Waypoint(raised(here, _CLEAR_M), OPEN, _PACE)
        return (yield from go(obs, lambda _: up, _PATIENCE_S))

    def _grip(self, now: OperatorObservation) -> Pose:
        """Return the tool that grips the own handle: fingers across the bar, which is square to the tray."""
        handle = self._handle(now).position
        x, y, _ = handle - self._partner_handle(now).position
        return upright(handle, (math.atan2(y, x) + math.pi / 2) % math.pi)


def raised(pose: Pose, height_m: float) -> Pose:
    """Return the same pose `height_m` higher."""
    return Pose(pose.position + np.array([0.0, 0.0, height_m]), pose.quaternion_wxyz)
