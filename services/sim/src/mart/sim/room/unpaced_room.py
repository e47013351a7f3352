"""A room that nobody waits for: the same seats, barrier, episode and world as a live one, on a clock that jumps to
whatever is due next. Scripts in this very process drive every arm, with Commands like anybody's.

What is said goes out as ever, so that a recorder records as ever; it is said in order and nothing is lost, which makes
the room as slow as who listens. Between episodes the world stands still: whoever asks for the next one sets the pace.
"""

from __future__ import annotations

import logging
import threading
from collections import Counter

from mart.protocol import clock, codec, keys
from mart.protocol.messages import OPERATOR_SCRIPT, Event, RoomStatus, SeatRequest, State, raise_error
from mart.protocol.tasks import Task
from mart.runtime.bus import Bus
from mart.runtime.throttled_log import ThrottledLog
from mart.sim.experts import Skill
from mart.sim.operate import REPEAT_S, ScriptedOperator
from mart.sim.room.room import REPEAT_S as STATUS_S
from mart.sim.room.room import Room
from mart.sim.room.work_queue import WorkQueue

_log = logging.getLogger(__name__)


class SimulatedTime:
    """Seconds as the room counts them; never back."""

    def __init__(self) -> None:
        self._now_s = 0.0

    def now_s(self) -> float:
        return self._now_s

    def reach(self, moment_s: float) -> None:
        self._now_s = max(self._now_s, moment_s)


class OrderedPublisher:
    """Speaks on the keys of a room, one thing after another. `newest` is the state that was told last."""

    def __init__(self, bus: Bus, room: str, arms: tuple[str, ...]) -> None:
        self.newest = State()
        self._state = bus.publisher(keys.in_order(keys.state(room)))
        self._event = bus.publisher(keys.in_order(keys.event(room)))
        self._commands = {arm: bus.publisher(keys.in_order(keys.command(room, arm))) for arm in arms}
        self._status = bus.publisher(keys.status(room))
        self._status_due_s = self._began_s = clock.monotonic_s()
        self._real_time_factor = 1.0

    def state(self, state: State) -> None:
        """The room keeps simulated time: how fast that really was is known here."""
        if state.sim_time_s > 0.0:
            self._real_time_factor = state.sim_time_s / (clock.monotonic_s() - self._began_s)
        else:
            self._began_s = clock.monotonic_s()
        state.real_time_factor = self._real_time_factor
        state.stamps.sent_ns = clock.wall_ns()
        self.newest = state
        self._state.put(codec.encode(state))

    def repeat_state(self) -> None:
        """Not here: nobody who comes late to an episode could follow it."""

    def status(self, status: RoomStatus) -> None:
        """As often as a live room says it, in real time."""
        if clock.monotonic_s() >= self._status_due_s:
            self._status_due_s = clock.monotonic_s() + STATUS_S
            status.real_time_factor = self._real_time_factor
            self._status.put(codec.encode(status))

    def event(self, event: Event) -> None:
        self._event.put(codec.encode(event))

    def command(self, arm: str, payload: bytes) -> None:
        self._commands[arm].put(payload)

    def close(self) -> None:
        for publisher in (self._state, self._event, self._status, *self._commands.values()):
            publisher.close()


class UnpacedRoom:
    """A room, where it speaks, its time, and a script on every seat."""

    def __init__(self, room: Room, publisher: OrderedPublisher, time: SimulatedTime) -> None:
        self._room, self._publisher, self._time = room, publisher, time
        self._operators: dict[str, ScriptedOperator] = {}
        self._act_s = time.now_s()

    def seat_scripts(self, task: Task, skill: Skill, seed: int) -> None:
        """People of one skill."""
        for arm in task.arm_names:
            assign = SeatRequest.Assign(arm=arm, operator=OPERATOR_SCRIPT)
            reply = self._room.answer_seat(SeatRequest(assign=assign), self._time.now_s())
            raise_error(reply.error)
            self._operators[arm] = ScriptedOperator(task, arm, reply.seat.epoch, skill, seed)

    def run(self, work_queue: WorkQueue, garbled: Counter[str], stop: threading.Event) -> None:
        """Until `stop` is set. What comes in is answered between episodes: whoever asks twice gets two."""
        throttled_log = ThrottledLog(_log)
        while not stop.is_set():
            throttled_log.report(Counter(self._room.rejected) + garbled, clock.monotonic_s())
            self._publisher.status(self._room.status(self._time.now_s()))
            work_queue.work_once(STATUS_S)
            self.play(stop)

    def play(self, stop: threading.Event) -> None:
        """The episode that has been asked for, if there is one, until the room is in practice again."""
        while not self._room.in_practice and not stop.is_set():
            next_s = self._room.advance(self._time.now_s())
            if not self._act():  # else the room looks again before time passes
                self._time.reach(min(next_s, self._act_s))

    def _act(self) -> bool:
        """Where something new is to be seen, everybody says what is to be done; else the same again, now and then.

        Whether anything was said.
        """
        now_s = self._time.now_s()
        news = [operator.see(self._publisher.newest) for operator in self._operators.values()]
        if not any(news) and now_s < self._act_s:
            return False
        self._act_s = now_s + REPEAT_S
        for arm, operator in self._operators.items():
            wall_ns = clock.wall_ns()
            command = operator.command(wall_ns)
            assert command is not None  # it has seen the world's first state
            payload = codec.encode(command)
            self._publisher.command(arm, payload)
            self._room.hear(payload, arm, now_s, wall_ns)
        return True
