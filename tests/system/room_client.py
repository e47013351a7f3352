"""Somebody who asks a room for things and drives its arms, over the real bus."""

from __future__ import annotations

import contextlib
from types import TracebackType
from typing import Self

from mart.protocol import clock, codec, keys
from mart.protocol.messages import (
    OPERATOR_HUMAN,
    Command,
    EpisodeRequest,
    Event,
    Model,
    Operator,
    PoseMessage,
    RoomReply,
    RoomStatus,
    Seat,
    SeatRequest,
    State,
)
from mart.runtime.bus.zenoh_bus import ZenohBus
from tests.support.message_collector import MessageCollector, NothingCame

_TIMEOUT_S = 30.0
_AHEAD = PoseMessage(x=0.5, y=0.0, z=0.2, qw=1.0)


class RoomClient:
    """Keeps what the room says in `states`, `statuses` and `events`."""

    def __init__(self, endpoint: str, room: str) -> None:
        self.room = room
        self._opened = contextlib.ExitStack()
        self.bus = self._opened.enter_context(ZenohBus.connect(endpoint))
        self.states = self._opened.enter_context(MessageCollector(self.bus, keys.state(room).key, State))
        self.statuses = self._opened.enter_context(
            MessageCollector(self.bus, keys.status(room).key, RoomStatus)
        )
        self.events = self._opened.enter_context(MessageCollector(self.bus, keys.event(room).key, Event))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, _type: type[BaseException] | None, _value: BaseException | None, _trace: TracebackType | None
    ) -> None:
        self._opened.close()

    def seat(self, request: SeatRequest) -> RoomReply:
        return codec.decode(
            RoomReply, self.bus.query(keys.seat(self.room), codec.encode(request), _TIMEOUT_S)
        )

    def claim(self, arm: str, holder_id: str, name: str = "Ana") -> RoomReply:
        claim = SeatRequest.Claim(arm=arm, holder_id=holder_id, name=name, operator=OPERATOR_HUMAN)
        return self.seat(SeatRequest(claim=claim))

    def assign(self, arm: str, operator: Operator) -> RoomReply:
        return self.seat(SeatRequest(assign=SeatRequest.Assign(arm=arm, operator=operator)))

    def episode(self, request: EpisodeRequest) -> RoomReply:
        return codec.decode(
            RoomReply, self.bus.query(keys.episode(self.room), codec.encode(request), _TIMEOUT_S)
        )

    def model(self) -> Model:
        return codec.decode(Model, self.bus.query(keys.model(self.room), b"", _TIMEOUT_S))

    def tick(self, *drivers: Driver, timeout_s: float = 10.0) -> State:
        """Everyone drives, again and again as people do, until a tick has used what they give; its state."""
        deadline_s = clock.monotonic_s() + timeout_s
        before = len(self.states)
        first = {driver.arm: driver.sequence + 1 for driver in drivers}

        def is_new(state: State) -> bool:
            return all(arm.sequence >= first.get(arm.arm, 0) for arm in state.arms)

        while True:
            for driver in drivers:
                driver.give()
            try:
                return self.states.wait_for(is_new, timeout_s=0.1, since=before)
            except NothingCame:
                if clock.monotonic_s() > deadline_s:
                    raise

    def driver(self, seat: Seat) -> Driver:
        return Driver(self.bus, self.room, seat)


class Driver:
    """Gives one command after another for a seat: the tool half a metre ahead of the base."""

    def __init__(self, bus: ZenohBus, room: str, seat: Seat) -> None:
        self.arm, self.epoch, self.sequence = seat.arm, seat.epoch, 0
        self._publisher = bus.publisher(keys.command(room, seat.arm))

    def give(self) -> int:
        """Sends the next command; its sequence number."""
        self.sequence += 1
        command = Command(
            arm=self.arm,
            seat_epoch=self.epoch,
            sequence=self.sequence,
            target_tool_in_base=_AHEAD,
            engaged=True,
        )
        command.stamps.sent_ns = clock.wall_ns()
        self._publisher.put(codec.encode(command))
        return self.sequence

    def give_bytes(self, payload: bytes) -> None:
        self._publisher.put(payload)
