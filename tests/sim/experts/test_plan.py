from __future__ import annotations

import numpy as np
import pytest

from mart.protocol.pose import Pose
from mart.sim.experts.plan import CLOSED, OPEN, OperatorObservation, PlanStep, Waypoint, go, pick, stay, wait
from tests.sim.experts.humans import human

TICK_S = 0.05
PLACE = Pose(np.array([0.5, 0.1, 0.02]), Pose.identity().quaternion_wxyz)
START = Pose(np.array([0.45, 0.0, 0.2]), Pose.identity().quaternion_wxyz)


def obs(now_s: float = 0.0, tool: Pose = START, arrived: bool = False) -> OperatorObservation:
    return OperatorObservation({}, now_s, tool, 0.0, arrived)


class Puppet:
    """An arm that is where it was told to be one tick later, unless something is in the way."""

    def __init__(self, lowest_z_m: float = -1.0) -> None:
        self.waypoints: list[Waypoint] = []
        self.now_s = 0.0
        self._lowest_z_m = lowest_z_m

    def perform(self, step: PlanStep) -> OperatorObservation:
        """Until the step is over; a minute at most."""
        waypoint = next(step)
        while self.now_s < 60.0:
            self.waypoints.append(waypoint)
            self.now_s += TICK_S
            there = waypoint.pose_tool_in_base
            x, y, z = there.position
            tool = Pose(np.array([x, y, max(z, self._lowest_z_m)]), there.quaternion_wxyz)
            try:
                waypoint = step.send(obs(self.now_s, tool, tool.distance_to(there)[0] < 0.004))
            except StopIteration as over:
                ended: OperatorObservation = over.value
                return ended
        pytest.fail("The step did not end within a minute.")


def test_going_ends_on_arrival() -> None:
    puppet = Puppet()
    ended = puppet.perform(go(obs(), lambda _: Waypoint(PLACE, OPEN)))
    assert ended.arrived
    assert puppet.now_s == pytest.approx(TICK_S)


def test_going_ends_when_patience_does() -> None:
    puppet = Puppet(lowest_z_m=0.05)
    ended = puppet.perform(go(obs(), lambda _: Waypoint(PLACE, OPEN), patience_s=1.0))
    assert not ended.arrived
    assert puppet.now_s == pytest.approx(1.0, abs=TICK_S)


def test_staying_lasts_as_long_as_it_was_asked() -> None:
    puppet = Puppet()
    puppet.perform(stay(obs(), Waypoint(PLACE, OPEN), 0.4))
    assert puppet.now_s == pytest.approx(0.4, abs=TICK_S)


@pytest.mark.parametrize(("skill", "notices_s"), [("expert", 0.15), ("novice", 0.6)])
def test_what_is_seen_is_acted_upon_as_late_as_the_person_notices(skill: str, notices_s: float) -> None:
    puppet = Puppet()
    puppet.perform(wait(obs(), Waypoint(PLACE, OPEN), human(skill), lambda now: now.sim_time_s > 1.0))
    assert 1.0 + 0.7 * notices_s <= puppet.now_s <= 1.0 + 1.3 * notices_s + 3 * TICK_S


def test_picking_goes_over_it_down_and_closes_there() -> None:
    puppet = Puppet()
    puppet.perform(pick(obs(), human(aim_m=0.0, aim_rad=0.0), lambda _: PLACE))
    heights = [waypoint.pose_tool_in_base.position[2] for waypoint in puppet.waypoints]
    assert max(heights) == heights[0]
    assert 0.07 <= heights[0] - 0.02 <= 0.13
    closed = [waypoint for waypoint in puppet.waypoints if waypoint.gripper == CLOSED]
    assert {waypoint.pose_tool_in_base.distance_to(PLACE)[0] < 1e-9 for waypoint in closed} == {True}
    assert 0.4 < len(closed) * TICK_S < 0.8


def test_whoever_aims_beside_it_closes_there_too() -> None:
    puppet = Puppet()
    puppet.perform(pick(obs(), human(aim_m=0.02), lambda _: PLACE))
    assert puppet.waypoints[-1].gripper == CLOSED
    assert puppet.waypoints[-1].pose_tool_in_base.distance_to(PLACE)[0] > 0.003


def test_fingers_that_stand_on_something_close_all_the_same() -> None:
    puppet = Puppet(lowest_z_m=0.06)
    puppet.perform(pick(obs(), human(), lambda _: PLACE))
    assert puppet.waypoints[-1].gripper == CLOSED


def test_a_thing_that_moves_is_followed_until_the_tool_goes_down() -> None:
    puppet = Puppet()

    def moving(now: OperatorObservation) -> Pose:
        return Pose(PLACE.position + np.array([0.1 * now.sim_time_s, 0.0, 0.0]), PLACE.quaternion_wxyz)

    puppet.perform(pick(obs(), human(aim_m=0.0, aim_rad=0.0), moving))
    down = [w.pose_tool_in_base.position for w in puppet.waypoints if w.pose_tool_in_base.position[2] < 0.03]
    assert len({position.tobytes() for position in down}) == 1
