"""What another program said last is said to the room again and again, and not for ever."""

from __future__ import annotations

import numpy as np
import pytest

from mart.lerobot_devices import SeatChoice, SeatSession
from mart.lerobot_devices.seat_session import HOLD_AFTER_S, LatestTarget
from mart.operators import SeatView, ToolTarget
from mart.protocol.errors import InvalidInput, Unavailable
from mart.protocol.pose import Pose
from mart.protocol.tasks import get_task

_MEASURED = Pose(np.array([0.4, 0.0, 0.2]), np.array([1.0, 0.0, 0.0, 0.0]))
_TARGET = ToolTarget(Pose(np.array([0.5, 0.0, 0.2]), np.array([1.0, 0.0, 0.0, 0.0])), gripper=0.7)
_VIEW = SeatView(
    task=get_task("two_arm_multi_cube_lifting", 2),
    episode=0,
    tick=1,
    sim_time_s=0.0,
    observations={},
    poses_tool_in_base={"arm0": _MEASURED},
)


@pytest.fixture
def now_s(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now_s = [100.0]
    monkeypatch.setattr("mart.protocol.clock.monotonic_s", lambda: now_s[0])
    return now_s


def test_before_a_first_action_the_arm_holds() -> None:
    assert LatestTarget().act(_VIEW) == {"arm0": ToolTarget(_MEASURED, 0.0, engaged=False)}


def test_the_newest_action_holds_for_a_while_and_then_the_clutch_is_let_go(now_s: list[float]) -> None:
    operator = LatestTarget()
    operator.say(_TARGET)
    now_s[0] += HOLD_AFTER_S - 0.1
    assert operator.act(_VIEW) == {"arm0": _TARGET}
    now_s[0] += 0.2
    assert operator.act(_VIEW) == {"arm0": ToolTarget(_MEASURED, 0.7, engaged=False)}


def test_a_new_world_knows_nothing_of_the_old_ones_action(now_s: list[float]) -> None:
    operator = LatestTarget()
    operator.say(_TARGET)
    operator.begin(2)
    assert not operator.act(_VIEW)["arm0"].engaged


def test_a_seat_is_no_scripts_and_is_used_once_it_is_held() -> None:
    with pytest.raises(InvalidInput):
        SeatSession(SeatChoice(kind="script"))
    session = SeatSession(SeatChoice())
    with pytest.raises(Unavailable):
        session.observe()
    session.close()
