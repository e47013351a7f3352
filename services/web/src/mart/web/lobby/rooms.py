"""The rooms on the bus: what they say keeps the lobby current, what people want becomes a query."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections import OrderedDict, deque
from collections.abc import Iterator

from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage

from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput, MartError, Unavailable
from mart.protocol.messages import (
    OPERATOR_HUMAN,
    EpisodeRequest,
    Event,
    Operator,
    Outcome,
    RoomReply,
    RoomsRequest,
    RoomStatus,
    Seat,
    SeatRequest,
    raise_error,
)
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Closable, Sample
from mart.web.access.user_sessions import User
from mart.web.lobby import thumbnails
from mart.web.lobby.lobby import Json, Lobby, event_json

_log = logging.getLogger(__name__)

PLATFORM = "platform"
QUERY_TIMEOUT_S = 5.0
PLATFORM_TIMEOUT_S = 45.0  # a sim that is stopped may take its time
_MAX_STATUS_BYTES = 64 * 1024
_MAX_THUMBNAIL_BYTES = thumbnails.MAX_BYTES + 1024
_MAX_WAITING_EVENTS = 64
_SETTLE_S = 2.0
_MAX_DELAYS = 256
_DELAY_FRESH_S = 10.0  # it is told once a second


class LobbyListener:
    """Told when anything changes. Holds the events that were not taken yet, newest 64."""

    def __init__(self) -> None:
        self._changed = asyncio.Event()
        self._events: deque[Json] = deque(maxlen=_MAX_WAITING_EVENTS)

    def tell(self, event: Json | None = None) -> None:
        if event is not None:
            self._events.append(event)
        self._changed.set()

    async def wait(self, timeout_s: float) -> None:
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._changed.wait(), timeout_s)
        self._changed.clear()

    def take_events(self) -> list[Json]:
        taken = list(self._events)
        self._events.clear()
        return taken


class Rooms:
    """Open from its making until `close`."""

    def __init__(self, bus: AsyncBus) -> None:
        self.lobby = Lobby()
        self._bus = bus
        self._services: dict[str, set[str]] = {}
        self._listeners: set[LobbyListener] = set()
        self._delays: OrderedDict[tuple[str, str], tuple[Event.Latency, float]] = OrderedDict()
        self._unreadable = 0
        self._last_warning_s = float("-inf")
        self._opened: list[Closable] = [
            bus.watch(keys.EVERY_ALIVE, self._on_alive),
            bus.subscribe(keys.EVERY_STATUS, self._on_status),
            bus.subscribe(keys.EVERY_EVENT, self._on_event),
            bus.subscribe(keys.EVERY_STILL, self._on_thumbnail),
        ]

    def close(self) -> None:
        while self._opened:
            self._opened.pop().close()

    async def settled(self) -> None:
        """Until every room that is open now has been heard of, so that the first page shows them all.

        A room speaks five times a second; one that is silent for `_SETTLE_S` is not waited for.
        """
        deadline_s = clock.monotonic_s() + _SETTLE_S
        with self.listen() as listener:
            await listener.wait(_SETTLE_S / 10)  # tokens that exist already come one by one
            while self.lobby.unheard and (left_s := deadline_s - clock.monotonic_s()) > 0:
                await listener.wait(left_s)

    def services(self) -> dict[str, list[str]]:
        """Who is alive: kind → ids."""
        return {kind: sorted(ids) for kind, ids in sorted(self._services.items()) if ids}

    def delays(self, now_s: float) -> list[tuple[str, Event.Latency]]:
        """Each seat's newest report of its motion to photon, with its room; nothing where nobody looks any more."""
        fresh = [(key, said) for key, (said, at_s) in self._delays.items() if now_s - at_s < _DELAY_FRESH_S]
        return [(room, said) for (room, _), said in sorted(fresh, key=lambda one: one[0])]

    @contextlib.contextmanager
    def listen(self) -> Iterator[LobbyListener]:
        listener = LobbyListener()
        self._listeners.add(listener)
        try:
            yield listener
        finally:
            self._listeners.discard(listener)

    @property
    def opens_rooms(self) -> bool:
        """Whether anything here opens and closes rooms."""
        return bool(self._services.get(PLATFORM))

    async def open(self, wanted: RoomsRequest.Open) -> str:
        """The new room's name; its sim comes up within seconds."""
        return await self._ask_platform(RoomsRequest(open=wanted))

    async def shut(self, room: str) -> str:
        """Closes a room in which no person sits."""
        return await self._ask_platform(RoomsRequest(close=RoomsRequest.Close(room=room)))

    async def claim(self, room: str, arm: str, user: User) -> Seat:
        claim = SeatRequest.Claim(arm=arm, holder_id=user.holder_id, name=user.name, operator=OPERATOR_HUMAN)
        return await self._ask_seat(room, arm, SeatRequest(claim=claim))

    async def release(self, room: str, arm: str, user: User) -> Seat:
        release = SeatRequest.Release(arm=arm, holder_id=user.holder_id)
        return await self._ask_seat(room, arm, SeatRequest(release=release))

    async def assign(self, room: str, arm: str, operator: Operator, policy: str = "") -> Seat:
        assign = SeatRequest.Assign(arm=arm, operator=operator, policy=policy)
        return await self._ask_seat(room, arm, SeatRequest(assign=assign))

    async def hand_back(self, room: str, arm: str, user: User) -> Seat:
        hand_back = SeatRequest.HandBack(arm=arm, holder_id=user.holder_id)
        return await self._ask_seat(room, arm, SeatRequest(hand_back=hand_back))

    async def set_ready(self, room: str, arm: str, user: User, ready: bool) -> None:
        request = EpisodeRequest.Ready(arm=arm, holder_id=self._say(room, user), ready=ready)
        await self._ask_episode(room, EpisodeRequest(ready=request))

    async def finish(self, room: str, user: User, outcome: Outcome) -> None:
        request = EpisodeRequest.Finish(holder_id=self._say(room, user), outcome=outcome)
        await self._ask_episode(room, EpisodeRequest(finish=request))

    async def reset(self, room: str, user: User) -> None:
        request = EpisodeRequest.Reset(holder_id=self._say(room, user))
        await self._ask_episode(room, EpisodeRequest(reset=request))

    def _say(self, room: str, user: User) -> str:
        """Whoever holds no seat speaks as anybody: the sim hears them where no human drives."""
        seats = self.lobby.status(room, clock.monotonic_s()).seats
        return user.holder_id if any(seat.holder_id == user.holder_id for seat in seats) else ""

    async def _ask_seat(self, room: str, arm: str, request: SeatRequest) -> Seat:
        self.lobby.seat(room, arm, clock.monotonic_s())
        reply = await self._ask(keys.seat(room), codec.encode(request))
        return reply.seat if reply.seat.arm else self.lobby.seat(room, arm, clock.monotonic_s())

    async def _ask_episode(self, room: str, request: EpisodeRequest) -> None:
        self.lobby.status(room, clock.monotonic_s())
        await self._ask(keys.episode(room), codec.encode(request))

    async def _ask_platform(self, request: RoomsRequest) -> str:
        running = self.services().get(PLATFORM, [])
        if not running:
            raise Unavailable(
                "Nothing here opens or closes rooms; where each part is started by hand, start a `mart sim`."
            )
        payload = await self._bus.query(keys.rooms(running[0]), codec.encode(request), PLATFORM_TIMEOUT_S)
        reply = codec.decode(RoomReply, payload, _MAX_STATUS_BYTES)
        raise_error(reply.error)
        return reply.status.room

    async def _ask(self, topic: keys.Topic, payload: bytes) -> RoomReply:
        reply = codec.decode(
            RoomReply, await self._bus.query(topic, payload, QUERY_TIMEOUT_S), _MAX_STATUS_BYTES
        )
        raise_error(reply.error)
        if reply.status.room:
            self._see(reply.status)
        return reply

    def _on_status(self, sample: Sample) -> None:
        try:
            status = codec.decode(RoomStatus, sample.payload, _MAX_STATUS_BYTES)
            if status.room != keys.room_of(sample.key):
                raise InvalidInput(f"A status of room {status.room!r} was given on {sample.key}.")
            self._see(status)
        except MartError as error:
            self._warn(sample.key, error)

    def _on_thumbnail(self, sample: Sample) -> None:
        try:
            image = codec.decode(CompressedImage, sample.payload, _MAX_THUMBNAIL_BYTES)
            room, camera = keys.room_of(sample.key), keys.camera_of(sample.key)
            self.lobby.thumbnails.see(room, camera, image.data, clock.monotonic_s())
        except MartError as error:
            self._warn(sample.key, error)

    def _on_event(self, sample: Sample) -> None:
        try:
            event = codec.decode(Event, sample.payload, _MAX_STATUS_BYTES)
            told = event_json(event)
        except MartError as error:
            self._warn(sample.key, error)
        else:
            if event.WhichOneof("what") == "latency":
                self._note_delay(event.room, event.latency)
            if told is not None:
                self._tell(told)

    def _note_delay(self, room: str, latency: Event.Latency) -> None:
        self._delays[room, latency.arm] = latency, clock.monotonic_s()
        self._delays.move_to_end((room, latency.arm))
        if len(self._delays) > _MAX_DELAYS:
            self._delays.popitem(last=False)

    def _on_alive(self, key: str, alive: bool) -> None:
        kind, name = key.split("/")[-2:]
        running = self._services.setdefault(kind, set())
        (running.add if alive else running.discard)(name)
        if kind == ServiceKind.SIM:
            self.lobby.set_alive(name, alive)
        self._tell()

    def _see(self, status: RoomStatus) -> None:
        self.lobby.see(status, clock.monotonic_s())
        self._tell()

    def _tell(self, event: Json | None = None) -> None:
        for listener in self._listeners:
            listener.tell(event)

    def _warn(self, key: str, error: MartError) -> None:
        self._unreadable += 1
        now_s = clock.monotonic_s()
        if now_s - self._last_warning_s >= 1.0:
            self._last_warning_s = now_s
            _log.warning("Ignored a message on %s (%d so far): %s", key, self._unreadable, error)
