"""Leave a plan for what a partner asks by a cue: let go of what is held, or come closer. It begins anew then."""

from __future__ import annotations

import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.sim.experts.human_error import CLOSING_S, HumanErrorModel
from mart.sim.experts.perception import apart_m, at, seen_tool
from mart.sim.experts.plan import OPEN, OperatorObservation, PlanStep, Waypoint, go, stay

_BACK_M = 0.12  # up, as plans leave what they have put down
_BESIDE_M = 0.14  # from the partner's tool: hands are 10 cm wide, and neither stands quite still
_PATIENCE_S = 4.0
_STAYS_S = 1.0


def let_go(obs: OperatorObservation, human: HumanErrorModel) -> PlanStep:
    """Open where the tool is, draw back, and stay there for a moment."""
    here = obs.pose_tool_in_base
    obs = yield from stay(obs, Waypoint(here, OPEN), CLOSING_S + human.settles_s())
    back = Waypoint(at(0.0, 0.0, _BACK_M) @ here, OPEN)
    obs = yield from go(obs, lambda _: back, patience_s=_PATIENCE_S)
    return (yield from stay(obs, back, _STAYS_S))


def come_closer(obs: OperatorObservation, arm: Arm, partner: str) -> PlanStep:
    """Come beside the partner's tool, from where the own one is, with open fingers."""
    partner_tool = seen_tool(arm, partner)

    def beside(now: OperatorObservation) -> Waypoint:
        tool, other = now.pose_tool_in_base, partner_tool(now)
        away_m = apart_m(tool, other)
        short_m = max(away_m - _BESIDE_M, 0.0)
        way = other.position - tool.position
        step = way * (short_m / away_m) if away_m > 0.0 else np.zeros(3)
        return Waypoint(Pose(tool.position + step, tool.quaternion_wxyz), OPEN)

    def is_beside(now: OperatorObservation) -> bool:
        return apart_m(now.pose_tool_in_base, partner_tool(now)) < _BESIDE_M + 0.01

    return (yield from go(obs, beside, _PATIENCE_S, unless=is_beside))
