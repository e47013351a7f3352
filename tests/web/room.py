"""A room on the bus without a world: the sim's own rules for seats and episodes, a status at every change."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator

from mart.protocol import clock, codec, keys
from mart.protocol.errors import MartError
from mart.protocol.holders import holder_tag
from mart.protocol.messages import (
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STOPPED,
    EpisodeRequest,
    Event,
    RoomReply,
    RoomStatus,
    Seat,
    SeatRequest,
    error_message,
)
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Bus, Request
from mart.sim.room.barrier import Barrier
from mart.sim.room.emergency_stop import StopLatch
from mart.sim.room.episode_state_machine import EpisodeStateMachine
from mart.sim.room.recording_rules import RecordingRules
from mart.sim.room.saved_room import SavedStop
from mart.sim.room.seats import SeatHolder, SeatTable

TASK = "two_arm_multi_cube_lifting"
_SPEAK_EVERY_S = 0.1


@contextlib.contextmanager
def speaking(room: Room) -> Iterator[None]:
    """Let a room say its status ten times a second, as a sim does: a single one may arrive before its token."""
    ended = threading.Event()

    def speak() -> None:
        while not ended.wait(_SPEAK_EVERY_S):
            room.publish()

    speaker = threading.Thread(target=speak, daemon=True)
    speaker.start()
    try:
        yield
    finally:
        ended.set()
        speaker.join()


class Room:
    """Open from its making until `close`, which takes its liveliness token away."""

    def __init__(self, bus: Bus, name: str = "room-1", arms: int = 2) -> None:
        task = get_task(TASK, arms)
        self.name = name
        self.seats = SeatTable(task.arm_names)
        self.course = EpisodeStateMachine(room_seed=1, horizon_ticks=task.horizon_ticks)
        self.tick = 1
        self.control_hz = 20.0
        self.plan = 0
        self.practice = self.course_required = False
        self._barrier = Barrier(task.arm_names, 0.05, 0.0)
        self._stop = StopLatch(self._barrier, self.seats, None, self._on_stop_changed, 0.0)
        self._subtasks = task.subtasks
        with contextlib.ExitStack() as opened:
            self._events = opened.enter_context(contextlib.closing(bus.publisher(keys.event(name))))
            self._statuses = opened.enter_context(contextlib.closing(bus.publisher(keys.status(name))))
            opened.enter_context(contextlib.closing(bus.serve(keys.seat(name), self._on_seat)))
            opened.enter_context(contextlib.closing(bus.serve(keys.episode(name), self._on_episode)))
            opened.enter_context(contextlib.closing(bus.announce(keys.alive(ServiceKind.SIM, name))))
            self._opened = opened.pop_all()
        self.publish()

    def close(self) -> None:
        self._opened.close()

    def status(self) -> RoomStatus:
        status = RoomStatus(
            room=self.name,
            task=TASK,
            control_hz=self.control_hz,
            tick=self.tick,
            real_time_factor=1.0,
            barrier=BARRIER_PHASE_STOPPED if self._barrier.stopped else BARRIER_PHASE_RUNNING,
            stop=self._stop.message(),
            seats=[self._seat(seat) for seat in self.seats],
            wall_ns=clock.wall_ns(),
            practice=self.practice,
            course_required=self.course_required,
        )
        if self.plan:
            status.plan.episodes = self.plan
        course = self.course
        status.episode.number, status.episode.phase = course.number, course.phase
        status.episode.outcome, status.episode.reason = course.outcome, course.reason
        status.episode.remaining_s = course.remaining_s(clock.monotonic_s())
        for subtask in self._subtasks:
            status.progress.subtasks.add(name=subtask.name)
        return status

    def publish(self) -> None:
        self._statuses.put(codec.encode(self.status()))

    def tell(self, event: Event) -> None:
        event.room = self.name
        self._events.put(codec.encode(event))

    def _seat(self, seat: SeatHolder) -> Seat:
        return Seat(
            arm=seat.arm,
            operator=seat.operator,
            epoch=seat.epoch,
            holder_tag=holder_tag("1", seat.arm, seat.epoch, seat.holder_id),
            name=seat.name,
            ready=self.course.is_ready(seat.arm),
            policy=seat.driver.policy,
            passed_course=seat.passed_course,
            relieved=seat.relieved.called if seat.relieved else "",
        )

    def _on_seat(self, request: Request) -> None:
        reply = RoomReply()
        try:
            seat = self.seats.answer(codec.decode(SeatRequest, request.payload))
            self.course.seats_changed(self.seats, clock.monotonic_s())
            reply.seat.CopyFrom(self._seat(seat))
        except MartError as error:
            reply.error.CopyFrom(error_message(error))
        self._reply(request, reply)

    def _on_episode(self, request: Request) -> None:
        reply = RoomReply()
        asked = codec.decode(EpisodeRequest, request.payload)
        try:
            match asked.WhichOneof("what"):
                case "stop":
                    self._stop.press(asked.stop, clock.monotonic_s())
                case "go_on":
                    self._stop.let_go(asked.go_on)
                case "set_plan":
                    self.plan = asked.set_plan.episodes
                case "require_course":
                    self.course_required = asked.require_course.required
                case _:
                    rules = RecordingRules(self.practice, self.course_required)
                    rules.require_may_begin(asked, self.seats)
                    self.course.answer(asked, self.seats, clock.monotonic_s())
        except MartError as error:
            reply.error.CopyFrom(error_message(error))
        self._reply(request, reply)

    def _on_stop_changed(self, _pressed: SavedStop | None, event: Event) -> None:
        self.tell(event)

    def _reply(self, request: Request, reply: RoomReply) -> None:
        reply.status.CopyFrom(self.status())
        request.reply(codec.encode(reply))
        self.publish()
