"""RoomManager that people open and close while the platform runs: each is a sim, kept running by the supervisor."""

from __future__ import annotations

import contextlib
import logging
import threading
from collections.abc import Iterator
from itertools import count

from mart.platform.run import saved_rooms as kept_rooms
from mart.platform.run.plan import (
    PlatformOptions,
    room,
)
from mart.platform.run.running import Platform
from mart.platform.run.supervisor import Supervisor
from mart.protocol import clock, keys
from mart.protocol.control_rate import require_control_hz
from mart.protocol.errors import Conflict, Corrupt, InvalidInput, MartError, NotFound
from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HUMAN,
    RoomReply,
    RoomsRequest,
    RoomStatus,
)
from mart.protocol.practice import require_practice_alone
from mart.protocol.queryables import ROOMS
from mart.protocol.received import decode_received
from mart.protocol.tasks import arm_kinds_of
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Request, Sample
from mart.runtime.serving import BoundedInbox, RequestAnswerer

_log = logging.getLogger(__name__)

NAME = "platform-1"
MAX_ROOMS = 8
MAX_EPISODES = 10_000
SILENCE_S = 60.0  # a sim that is started anew takes a moment, and remembers who sat where
_MAX_STATUS_BYTES = 64 * 1024
_MAX_WAITING = 16
_STOP_CHECK_S = 0.5


class HeardStatuses:
    """The newest status of each room. One that has been silent for a minute says nothing any more: its sim is gone."""

    def __init__(self) -> None:
        self._heard: dict[str, tuple[RoomStatus, float]] = {}

    def hear(self, status: RoomStatus, now_s: float) -> None:
        """Keep `status` as its room's newest; `now_s`: monotonic seconds."""
        self._heard[status.room] = status, now_s

    def newest(self, room: str, now_s: float) -> RoomStatus:
        """Return what a room said last; an empty status where it says nothing."""
        status, heard_s = self._heard.get(room, (RoomStatus(), now_s))
        return status if now_s - heard_s <= SILENCE_S else RoomStatus()

    def forget(self, room: str) -> None:
        """Forget a room that was closed."""
        self._heard.pop(room, None)


class RoomManager:
    """Which rooms run here. `statuses`: what each room said last. Raises MartError for what cannot be."""

    def __init__(self, options: PlatformOptions, supervisor: Supervisor, statuses: HeardStatuses) -> None:
        self._options, self._supervisor, self._statuses = options, supervisor, statuses
        self._path = options.data_dir / "rooms.jsonl"
        self._kept: dict[str, RoomsRequest.Open] = {}

    @property
    def names(self) -> list[str]:
        return sorted(process.id for process in self._supervisor.processes if process.kind == ServiceKind.SIM)

    def answer(self, request: RoomsRequest) -> RoomReply:
        match request.WhichOneof("what"):
            case "open":
                return RoomReply(status=RoomStatus(room=self._open(request.open)))
            case "close":
                self._close(request.close.room, with_people=request.close.with_people)
                return RoomReply(status=RoomStatus(room=request.close.room))
        raise InvalidInput("An empty request was given; ask to open or to close a room.")

    def reopen(self) -> None:
        """Those that people had opened when the platform was stopped; says which cannot come back."""
        try:
            kept = kept_rooms.load(self._path)
        except Corrupt as error:
            _log.warning("%s", error)
            return
        for wanted in kept:
            try:
                if wanted.room not in self.names:  # or it is the first room now
                    self._start(wanted)
                self._kept[wanted.room] = wanted
            except MartError as error:
                _log.warning("Room %s does not come back: %s", wanted.room, error)

    def _open(self, asked: RoomsRequest.Open) -> str:
        wanted = RoomsRequest.Open(
            room=asked.room or self._free_name(),
            task=asked.task,
            control_hz=asked.control_hz,
            episodes=asked.episodes,
            arms=asked.arms,
            practice=asked.practice,
            course_required=asked.course_required,
            arm_kinds=asked.arm_kinds,
        )
        self._start(wanted)
        self._kept[wanted.room] = wanted
        self._keep()
        return wanted.room

    def _start(self, wanted: RoomsRequest.Open) -> None:
        keys.status(wanted.room)  # raises where a room cannot be called so
        arm_kinds_of(wanted.task, wanted.arms or None, wanted.arm_kinds)
        if wanted.control_hz:
            require_control_hz(wanted.control_hz)
        if wanted.episodes > MAX_EPISODES:
            raise InvalidInput(
                f"{wanted.episodes} episodes were given; plan at most {MAX_EPISODES}, or none (0)."
            )
        require_practice_alone(
            practice=wanted.practice, course_required=wanted.course_required, episodes=wanted.episodes
        )
        if wanted.room in self.names:
            raise Conflict(f"{wanted.room!r} is open already; give the new room another name.")
        if len(self.names) >= MAX_ROOMS:
            raise Conflict(f"{len(self.names)} rooms are open, which is the most; close one first.")
        self._supervisor.add(room(self._options, wanted))
        _log.info("%s is opened for %s", wanted.room, wanted.task)

    def _keep(self) -> None:
        """A disk that is full must not take a room from people."""
        try:
            kept_rooms.save(self._path, self._kept.values())
        except OSError as error:
            _log.warning("A restart would forget this change of the rooms: %s.", error)

    def _free_name(self) -> str:
        """Of no room that ever was: under a name that was used, a room goes on where it was."""
        used = {path.stem for path in (self._options.data_dir / "rooms").glob("*.json")}
        return next(free for n in count(1) if (free := f"room-{n}") not in used.union(self.names))

    def _close(self, name: str, *, with_people: bool) -> None:
        if name not in self.names:
            raise NotFound.named("room", name, self.names)
        status = self._statuses.newest(name, clock.monotonic_s())
        people = [seat.name for seat in status.seats if seat.operator == OPERATOR_HUMAN]
        if people and not with_people:
            raise Conflict(
                f"{name} was to be closed, but {' and '.join(people)} can still drive there; leave first."
            )
        if status.episode.phase in (EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_RECORDING):
            raise Conflict(f"{name} was to be closed, but an episode is being recorded; end it first.")
        self._supervisor.remove(
            next(one.name for one in self._supervisor.processes if one.id == name and one.kind == "sim")
        )
        self._statuses.forget(name)
        self._kept.pop(name, None)
        self._keep()
        _log.info("%s is closed", name)


@contextlib.contextmanager
def opening_rooms(platform: Platform) -> Iterator[None]:
    """Answers while the block runs, on a thread of its own; what was open when the platform was stopped comes back.

    For a platform that runs its services itself.
    """
    assert platform.supervisor is not None
    inbox = BoundedInbox[Request](_MAX_WAITING)
    statuses = HeardStatuses()
    rooms = RoomManager(platform.options, platform.supervisor, statuses)
    rooms.reopen()

    def on_status(sample: Sample) -> None:
        with contextlib.suppress(InvalidInput):  # the rooms' own service tells of it
            status = decode_received(RoomStatus, sample.payload, _MAX_STATUS_BYTES)
            if status.room in rooms.names:
                statuses.hear(status, clock.monotonic_s())

    def work() -> None:
        answerer = rooms_answerer(rooms)
        while not ended.is_set():
            request = inbox.take(_STOP_CHECK_S)
            if request is not None:
                answerer.respond(request)

    ended = threading.Event()
    worker = threading.Thread(target=work, name="rooms")
    with contextlib.ExitStack() as stack:
        worker.start()
        stack.callback(worker.join)
        stack.callback(ended.set)
        for opened in (
            platform.bus.subscribe(keys.EVERY_STATUS, on_status),
            platform.bus.serve(keys.rooms(NAME), inbox.put),
            platform.bus.announce(keys.alive(ServiceKind.PLATFORM, NAME)),
        ):
            stack.callback(opened.close)
        yield


def rooms_answerer(rooms: RoomManager) -> RequestAnswerer[RoomsRequest, RoomReply]:
    """What answers encoded requests for `rooms`."""
    return RequestAnswerer(ROOMS, rooms.answer)
