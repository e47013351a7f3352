"""Any course of commands, seat changes and time, held against a plain account of what was said."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STALLED,
    BARRIER_PHASE_STOPPED,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    OPERATOR_SCRIPT,
    Operator,
)
from mart.sim.room.barrier import FREED_AFTER_S, PAUSED_AFTER_S, STALLED_AFTER_S, Barrier
from mart.sim.room.pacing import CATCH_UP_TICKS
from tests.sim.room.commands import received

pytestmark = pytest.mark.slow

ARMS = ("arm0", "arm1", "arm2")
PERIOD_S = 0.05
EPSILON_S = 1e-9

arms = st.sampled_from(ARMS)


@dataclass
class Said:
    """What one seat's holder has said so far."""

    operator: Operator = OPERATOR_HOLD
    epoch: int = 0
    heard_s: float = 0.0
    accepted: dict[int, bool] = field(default_factory=dict)  # sequence → emergency stop
    used: int = -1
    void: int = -1  # given before the world was reset
    restored: bool = False

    @property
    def newest(self) -> int:
        return max(self.accepted, default=-1)

    @property
    def away(self) -> bool:
        given_up = self.operator in (OPERATOR_HUMAN, OPERATOR_POLICY)
        return self.restored and given_up and not self.accepted

    @property
    def fresh(self) -> bool:
        return self.newest > max(self.used, self.void)


class BarrierMachine(RuleBasedStateMachine):
    def __init__(self) -> None:
        super().__init__()
        self.now_s = 100.0
        self.barrier = Barrier(ARMS, PERIOD_S, self.now_s)
        self.said = {arm: Said(heard_s=self.now_s) for arm in ARMS}
        self.fired_s: list[float] = []
        self.stopped: set[str] | None = None  # where it was pressed

    def driven(self) -> dict[str, Said]:
        return {arm: said for arm, said in self.said.items() if said.operator != OPERATOR_HOLD}

    @rule(
        arm=arms,
        operator=st.sampled_from([OPERATOR_HOLD, OPERATOR_HUMAN, OPERATOR_POLICY, OPERATOR_SCRIPT]),
        restored=st.booleans(),
    )
    def change_seat(self, arm: str, operator: Operator, restored: bool) -> None:
        epoch = self.said[arm].epoch + 1
        self.said[arm] = Said(operator, epoch, self.now_s, restored=restored)
        self.barrier.seat(arm, operator, epoch, self.now_s, restored=restored)

    @rule(arm=arms, step=st.integers(-2, 3), epoch_off=st.sampled_from([0, 0, 0, -1, 1]), stop=st.booleans())
    def command(self, arm: str, step: int, epoch_off: int, stop: bool) -> None:
        self._command(arm, step, epoch_off, stop)

    @rule(arm=arms, step=st.integers(1, 3))
    def good_command(self, arm: str, step: int) -> None:
        self._command(arm, step, 0, stop=False)

    @rule(step=st.integers(1, 3))
    def good_commands_of_everyone(self, step: int) -> None:
        for arm in ARMS:
            self._command(arm, step, 0, stop=False)

    def _command(self, arm: str, step: int, epoch_off: int, stop: bool) -> None:
        said = self.said[arm]
        epoch, sequence = max(0, said.epoch + epoch_off), max(0, said.newest + step)
        good = said.operator != OPERATOR_HOLD and epoch == said.epoch and sequence > said.newest
        before = self.barrier.rejected.total()
        rejection = self.barrier.offer(received(arm, epoch, sequence, self.now_s, stop))
        assert (rejection is None) == good
        assert self.barrier.rejected.total() - before == (not good)
        if good:
            if stop and not said.accepted.get(said.newest) and self.stopped is None:
                self.stopped = {arm}
            said.accepted[sequence] = stop
            said.heard_s = self.now_s

    @rule(arm=st.sampled_from([*ARMS, ""]))
    def press_stop(self, arm: str) -> None:
        self.barrier.stop(arm, self.now_s)
        if self.stopped is None:
            self.stopped = {arm} - {""}

    @rule()
    def let_go_of_stop(self) -> None:
        self.barrier.let_go()
        self.stopped = None

    @rule()
    def reset_world(self) -> None:
        self.barrier.restart(self.now_s)
        self.fired_s.clear()
        for said in self.said.values():
            said.void = said.newest

    @rule(
        elapsed_s=st.sampled_from([0.0, 0.004, 0.016, 0.05, 0.26, 1.0, 3.0, 31.0]),
        gate_open=st.booleans(),
        awaits_away=st.booleans(),
    )
    def time_passes(self, elapsed_s: float, gate_open: bool, awaits_away: bool) -> None:
        self.now_s += elapsed_s
        self._advance(gate_open, awaits_away)

    @rule()
    def follow_the_advice(self) -> None:
        """Called exactly when the barrier asks for it, it never asks for nothing at all."""
        next_s = self.barrier.advance(self.now_s, gate_open=False).next_s
        if next_s != float("inf"):
            assert next_s >= self.now_s
            self.now_s = next_s
            self._advance(gate_open=True, awaits_away=True)

    def _advance(self, gate_open: bool, awaits_away: bool) -> None:
        decision = self.barrier.advance(self.now_s, gate_open, awaits_away=awaits_away)
        driven = {arm: said for arm, said in self.driven().items() if awaits_away or not said.away}
        silence_s = {arm: self.now_s - said.heard_s for arm, said in driven.items()}
        longest_s = max(silence_s.values(), default=0.0)
        self._check_kept(set(decision.silent))

        expected = BARRIER_PHASE_RUNNING
        if self.stopped is not None:
            expected = BARRIER_PHASE_STOPPED
        elif longest_s >= PAUSED_AFTER_S:
            expected = BARRIER_PHASE_PAUSED
        elif longest_s >= STALLED_AFTER_S:
            expected = BARRIER_PHASE_STALLED
        assert decision.phase == expected
        missing = {arm for arm, since_s in silence_s.items() if since_s >= STALLED_AFTER_S}
        assert {arm for arm, _ in decision.waiting_for} == (missing if self.stopped is None else self.stopped)

        may_fire = gate_open and expected in (BARRIER_PHASE_RUNNING, BARRIER_PHASE_STALLED)
        complete = all(said.fresh for said in driven.values())
        if decision.inputs is None:
            assert not (may_fire and complete and self._pace_allows())
            return
        assert may_fire
        assert complete
        assert {arm: used.sequence for arm, used in decision.inputs.commands.items()} == {
            arm: said.newest for arm, said in driven.items()
        }
        assert decision.inputs.late_s >= 0.0
        assert (decision.inputs.straggler is None) == (not driven)
        self.fired_s.append(self.now_s)
        for said in driven.values():
            said.used = said.newest

    def _check_kept(self, silent: set[str]) -> None:
        """A seat is kept for 30 s from its holder's last word, whether anybody waits or not."""
        silence_s = {
            arm: self.now_s - said.heard_s
            for arm, said in self.driven().items()
            if said.operator != OPERATOR_SCRIPT
        }
        assert silent == {arm for arm, since_s in silence_s.items() if since_s >= FREED_AFTER_S}
        for arm, said in self.said.items():
            since_s = silence_s.get(arm, 0.0)
            kept = said.away or since_s >= PAUSED_AFTER_S
            expected_s = max(0.0, FREED_AFTER_S - since_s) if kept else 0.0
            assert self.barrier.kept_s(arm, self.now_s) == expected_s

    def _pace_allows(self) -> bool:
        """A whole period after the last tick, no pace forbids the next one."""
        return not self.fired_s or self.now_s >= self.fired_s[-1] + PERIOD_S + EPSILON_S

    @invariant()
    def never_faster_than_real_time(self) -> None:
        for first, began_s in enumerate(self.fired_s):
            ticks = len(self.fired_s) - first
            assert ticks <= (self.fired_s[-1] - began_s) / PERIOD_S + 1 + CATCH_UP_TICKS + 1e-6


BarrierMachine.TestCase.settings = settings(max_examples=150, stateful_step_count=60, deadline=None)
TestAnyCourse = BarrierMachine.TestCase
