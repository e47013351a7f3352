"""Run a room that nobody waits for, with its scripts, as fast as the machine and its listeners allow.

Seats, barrier, episode and world are those of a live room, on a clock that jumps to whatever is due next. Scripts in
this very process drive every arm, with Commands like anybody's. What is said goes out as ever, so that a recorder
records as ever; it is said in order and nothing is lost, which makes the room as slow as who listens. Between episodes
the world stands still: whoever asks for the next one sets the pace.
"""

from __future__ import annotations

import logging
import threading
from collections import Counter
from collections.abc import Callable, Sequence

from mart.operators.commander import SeatCommander
from mart.operators.driver import REPEAT_S
from mart.protocol import clock, codec
from mart.protocol.messages import OPERATOR_SCRIPT, SeatRequest, raise_error
from mart.protocol.tasks import Task
from mart.runtime.skill_option import ScriptedPerson
from mart.runtime.throttled_log import ThrottledLog
from mart.sim.experts import ScriptedOperator, get_skill
from mart.sim.room.bus_publisher import OrderedPublisher
from mart.sim.room.room import Room
from mart.sim.room.room_publisher import STATUS_S
from mart.sim.room.work_queue import WorkQueue

_log = logging.getLogger(__name__)


class SimulatedTime:
    """Count the room's seconds; they never go back."""

    def __init__(self) -> None:
        self._now_s = 0.0

    def now_s(self) -> float:
        """Return the present moment."""
        return self._now_s

    def reach(self, moment_s: float) -> None:
        """Go on to this moment, unless it is past."""
        self._now_s = max(self._now_s, moment_s)


class UnpacedRoom:
    """Run a room with its publisher, its time, and a script on every seat; `on_turn` is called again and again."""

    def __init__(
        self, room: Room, publisher: OrderedPublisher, time: SimulatedTime, on_turn: Callable[[], None]
    ) -> None:
        self._room, self._publisher, self._time, self._on_turn = room, publisher, time, on_turn
        self._commanders: list[SeatCommander] = []
        self._act_s = time.now_s()

    def seat_scripts(self, task: Task, people: Sequence[ScriptedPerson], seed: int) -> None:
        """Put a script on every seat: one person for each of the task's arms. Raises NotFound for an unknown skill."""
        for arm, person in zip(task.arm_names, people, strict=True):
            assign = SeatRequest.Assign(arm=arm, operator=OPERATOR_SCRIPT, name=person.name)
            reply = self._room.answer_seat(SeatRequest(assign=assign), self._time.now_s())
            raise_error(reply.error)
            operator = ScriptedOperator(task, arm, get_skill(person.skill), seed)
            commander = SeatCommander(operator, task, (arm,), OPERATOR_SCRIPT)
            commander.seat({arm: reply.seat.epoch})
            self._commanders.append(commander)

    def run(self, work_queue: WorkQueue, garbled: Counter[str], stop: threading.Event) -> None:
        """Run until `stop` is set. Requests are answered between episodes: whoever asks twice gets two."""
        throttled_log = ThrottledLog(_log)
        while not stop.is_set():
            self._on_turn()
            throttled_log.report(Counter(self._room.rejected) + garbled, clock.monotonic_s())
            self._publisher.status(self._room.status(self._time.now_s()))
            work_queue.run_one(STATUS_S)
            self.play(stop)

    def play(self, stop: threading.Event) -> None:
        """Play the episode that has been asked for, if there is one, until the room is in practice again."""
        while not self._room.in_practice and not stop.is_set():
            self._on_turn()
            next_s = self._room.advance(self._time.now_s())
            if not self._act():  # else the room looks again before time passes
                self._time.reach(min(next_s, self._act_s))

    def _act(self) -> bool:
        """Let everybody say what to do where there is news, else repeat now and then; return whether they spoke."""
        now_s = self._time.now_s()
        news = [commander.observe(self._publisher.newest) for commander in self._commanders]
        if not any(news) and now_s < self._act_s:
            return False
        self._act_s = now_s + REPEAT_S
        for commander in self._commanders:
            wall_ns = clock.wall_ns()
            for command in commander.commands(wall_ns):
                payload = codec.encode(command)
                self._publisher.command(command.arm, payload)
                self._room.hear(payload, command.arm, now_s, wall_ns)
        return True
