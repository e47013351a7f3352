"""Led arms go the whole way; one that stays behind is waited for, and then given up; a reset ends everything."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from mart.operators import ToolTarget
from mart.protocol.errors import Conflict
from mart.protocol.pose import Pose
from mart.recorder.replay.led_way import RecordedWay
from mart.recorder.replay.way_operator import LET_GO_TICKS, STALLS_AFTER_S, WayOperator
from tests.recorder.replay.ways import ARMS, BEGIN_M, DOWN, PERIOD_S, swung, view

AT_BEGIN = dict.fromkeys(ARMS, Pose(BEGIN_M, DOWN))
Follow = Callable[[str, ToolTarget, Pose], Pose]


class Led:
    """A way operator and arms that do as `follow` says."""

    def __init__(self, follow: Follow) -> None:
        self.ended = 0
        self.operator = WayOperator(RecordedWay.of(swung(20), ARMS), 0.5, 1.0 / PERIOD_S, self._done)
        self.tools: Mapping[str, Pose] = AT_BEGIN
        self.ticks = 0
        self._follow = follow
        self.operator.begin(0)

    def tick(self) -> Mapping[str, ToolTarget]:
        self.ticks += 1
        targets = self.operator.act(view(self.ticks, self.tools))
        self.tools = {arm: self._follow(arm, targets[arm], tool) for arm, tool in self.tools.items()}
        return targets

    def go(self) -> None:
        while not self.ended:
            self.tick()

    def _done(self) -> None:
        self.ended += 1


def at_once(_arm: str, target: ToolTarget, tool: Pose) -> Pose:
    return target.pose_tool_in_base if target.engaged else tool


def test_it_lets_the_clutch_go_first_and_goes_the_whole_way_at_half_the_speed() -> None:
    led = Led(at_once)
    assert [led.tick()["arm0"].engaged for _ in range(LET_GO_TICKS + 1)] == [False] * LET_GO_TICKS + [True]
    led.go()
    assert led.ticks == pytest.approx(LET_GO_TICKS + 20 / 0.5, abs=2)
    assert led.operator.time_s == pytest.approx(20 * PERIOD_S / 0.5)


def test_it_waits_for_an_arm_that_is_behind_and_gives_up_where_that_lasts() -> None:
    led = Led(lambda arm, target, tool: tool if arm == "arm1" else target.pose_tool_in_base)
    with pytest.raises(Conflict, match=r"arm1 is 0\.0[56] m and 0\.00 rad behind the way.*within 3 s"):
        led.go()
    stalled_at_s = led.operator.time_s
    assert led.ended == 0
    assert led.ticks * PERIOD_S == pytest.approx(stalled_at_s + STALLS_AFTER_S, abs=0.5)


def test_a_reset_of_the_world_or_a_seat_that_was_another_s_meanwhile_ends_it() -> None:
    led = Led(at_once)
    led.tick()
    with pytest.raises(Conflict, match="the replay is over"):
        led.operator.begin(1)


def test_an_arm_that_was_moved_away_since_it_was_looked_at_is_not_led() -> None:
    led = Led(at_once)
    led.tools = AT_BEGIN | {"arm1": Pose(BEGIN_M + np.array([0.0, 0.0, 0.3]), DOWN)}
    with pytest.raises(Conflict, match="arm1 stands too far"):
        led.go()
    assert led.ticks == LET_GO_TICKS + 1
