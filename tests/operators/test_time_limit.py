"""A program that hangs is left."""

from __future__ import annotations

import threading
from collections.abc import Mapping

import pytest

from mart.operators import ObedientOperator, Operator, SeatView, ToolTarget
from mart.operators.commander import SeatCommander
from mart.operators.time_limit import TimeLimitedOperator
from mart.protocol import clock
from mart.protocol.errors import InvalidInput, Unavailable
from mart.protocol.messages import CUE_GO, OPERATOR_POLICY, Cue
from tests.operators.rooms import TASK, Riser, state_of


class Hanging(Operator):
    def __init__(self) -> None:
        self.freed = threading.Event()

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        self.freed.wait()
        return {}


class Failing(Operator):
    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        raise KeyError("arm7")


def observe(operator: Operator, limit_s: float) -> SeatCommander:
    commander = SeatCommander(TimeLimitedOperator(operator, limit_s), TASK, ("arm0",), OPERATOR_POLICY)
    commander.seat({"arm0": 2})
    commander.observe(state_of(1))
    return commander


def test_who_answers_in_time_is_heard() -> None:
    riser = Riser()
    assert len(observe(riser, limit_s=60.0).commands(0)) == 1
    assert riser.begun == [1]


def test_what_takes_long_beforehand_is_waited_for_on_its_thread() -> None:
    class Loading(Riser):
        loaded_on = acted_on = 0

        def prepare(self) -> None:
            self.loaded_on = threading.get_ident()

        def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
            self.acted_on = threading.get_ident()
            return super().act(view)

    loading = Loading()
    limited = TimeLimitedOperator(loading, 60.0)
    limited.prepare()
    commander = SeatCommander(ObedientOperator(limited), TASK, ("arm0",), OPERATOR_POLICY)
    commander.seat({"arm0": 2})
    commander.observe(state_of(1))
    assert loading.loaded_on == loading.acted_on != threading.get_ident()


def test_nothing_limits_what_takes_long_beforehand() -> None:
    class Slow(Riser):
        def prepare(self) -> None:
            clock.sleep_s(0.1)

    TimeLimitedOperator(Slow(), 0.01).prepare()


def test_a_cue_is_handed_on() -> None:
    class Listener(Riser):
        heard: Cue | None = None

        def on_cue(self, cue: Cue, arm: str) -> None:
            self.heard = cue

    listener = Listener()
    observe(listener, limit_s=60.0).hear(CUE_GO, "arm1", tick=1)
    assert listener.heard == CUE_GO


def test_who_hangs_is_given_up() -> None:
    hanging = Hanging()
    with pytest.raises(Unavailable):
        observe(hanging, limit_s=0.01)
    hanging.freed.set()


def test_what_fails_on_the_other_thread_is_told_here() -> None:
    with pytest.raises(InvalidInput):
        observe(Failing(), limit_s=60.0)
