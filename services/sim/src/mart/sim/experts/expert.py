"""Drive one arm by script. Pure: it is shown what that arm's operator sees and says what it wants."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from mart.operators.obedience import held, is_closed
from mart.operators.operator import ToolTarget
from mart.protocol.pose import Pose
from mart.protocol.tasks import Task, gripper_observation
from mart.sim.experts.detours import come_closer, let_go
from mart.sim.experts.hand_motion import HandMotion
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.plan import CLOSED, OPEN, ExpertPlan, OperatorObservation, PlanStep, Waypoint
from mart.sim.experts.plans import plan_of
from mart.sim.experts.skill import Skill

_SAME_WAYPOINT_M = 0.05  # a waypoint that jumps further than this is a new movement
_SLIP_S = 0.4  # how long a hand that slipped stays open

Detour = Callable[[OperatorObservation], PlanStep]


class Expert:
    """Drive one arm for one episode. Copes with observations that arrive some ticks late, repeatedly or not at all.

    Time is the sim's: an expert that is shown the same moment again wants the same thing again.
    """

    def __init__(self, task: Task, arm: str, skill: Skill, random: np.random.Generator) -> None:
        self._task, self._arm = task, task.arm(arm)
        self._plan_of = plan_of(task)
        self._human = HumanErrorModel(skill, random)
        self._hand = HandMotion(self._human)
        self._plan: ExpertPlan | None = None
        self._waypoint: Waypoint | None = None
        self._intent: ToolTarget | None = None
        self._seen_s = 0.0
        self._rest_until_s = 0.0
        self._slip_until_s = 0.0
        self._detour: Detour | None = None
        self._told_to_go = False

    def pause(self, pose_tool_in_base: Pose) -> ToolTarget:
        """Return the target of an arm that holds still from here on; the next `act` moves it from where it is then."""
        self._hand.rest(pose_tool_in_base)
        return held(self._intent, pose_tool_in_base)

    def go_on(self) -> None:
        """Tell it, when it acts next, that it may go on: it waits for its partners no longer."""
        self._told_to_go = True

    def let_go(self) -> None:
        """Open the gripper where it holds something, draw back, and begin the plan anew."""
        if is_closed(self._intent):
            self._detour = lambda obs: let_go(obs, self._human)

    def come_closer(self, partner: str) -> None:
        """Come to the tool of the arm `partner` where the hand is empty, and begin the plan anew, told to go on."""
        if partner in self._task.arm_names and not is_closed(self._intent):
            self._detour = lambda obs: self._come_closer(obs, partner)

    def act(self, observations: Mapping[str, NDArray[np.float64]], sim_time_s: float) -> ToolTarget:
        """Return what the operator wants; observations: what the task declares for this arm."""
        if self._intent is None or sim_time_s > self._seen_s:
            self._intent = self._want(self._look(observations, sim_time_s))
            self._seen_s = sim_time_s
        return self._intent

    def _want(self, obs: OperatorObservation) -> ToolTarget:
        now_s, measured = obs.sim_time_s, obs.pose_tool_in_base
        elapsed_s = now_s - self._seen_s if self._intent is not None else 0.0
        waypoint = self._waypoint = self._next_waypoint(obs)
        gripper = self._grip(waypoint, now_s, elapsed_s)
        if now_s < self._rest_until_s:
            return ToolTarget(self._hand.rest(measured), gripper, engaged=False)
        target = self._hand.move(waypoint.pose_tool_in_base, measured, waypoint.pace, elapsed_s)
        return ToolTarget(target, gripper, engaged=True)

    def _look(
        self, observations: Mapping[str, NDArray[np.float64]], sim_time_s: float
    ) -> OperatorObservation:
        name = self._arm.name
        tool = Pose(
            observations[f"{name}/tool_position_in_base"], observations[f"{name}/tool_quaternion_in_base"]
        )
        arrived = self._waypoint is not None and self._hand.has_reached(
            self._waypoint.pose_tool_in_base, tool
        )
        told, self._told_to_go = self._told_to_go, False
        seen = observations.get(gripper_observation(name))
        gripper = 0.0 if seen is None else float(seen[0])
        return OperatorObservation(observations, sim_time_s, tool, gripper, arrived, told)

    def _next_waypoint(self, obs: OperatorObservation) -> Waypoint:
        if self._plan is None or self._waypoint is None:
            self._plan = self._plan_of(self._arm, self._human, obs)
            self._rest_until_s = obs.sim_time_s + self._human.reacts_s()
            return next(self._plan)
        if self._detour is not None:
            detour, self._detour = self._detour, None
            self._plan = self._plan_after(detour, obs)
            self._rest_until_s = obs.sim_time_s
            return next(self._plan)
        if obs.sim_time_s < self._rest_until_s:
            self._told_to_go = obs.told_to_go
            return self._waypoint
        waypoint = self._plan.send(obs)
        if _is_new(waypoint, self._waypoint):
            self._rest_until_s = obs.sim_time_s + self._human.pauses_s()
        return waypoint

    def _plan_after(self, detour: Detour, obs: OperatorObservation) -> ExpertPlan:
        obs = yield from detour(obs)
        yield from self._plan_of(self._arm, self._human, obs)

    def _come_closer(self, obs: OperatorObservation, partner: str) -> PlanStep:
        obs = yield from come_closer(obs, self._arm, partner)
        self.go_on()
        return obs

    def _grip(self, waypoint: Waypoint, now_s: float, elapsed_s: float) -> float:
        """Say what the gripper is told: a hand that should stay closed opens now and then for a moment."""
        if waypoint.gripper >= CLOSED and self._human.lets_slip(elapsed_s):
            self._slip_until_s = now_s + _SLIP_S
        return OPEN if now_s < self._slip_until_s else waypoint.gripper


def _is_new(waypoint: Waypoint, last: Waypoint) -> bool:
    way_m, _ = waypoint.pose_tool_in_base.distance_to(last.pose_tool_in_base)
    return way_m > _SAME_WAYPOINT_M
