"""A room as a seat sees it on the bus: a real world and real messages, ticked by the test instead of a barrier."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass

import numpy as np

from mart.protocol import clock, codec, keys
from mart.protocol.messages import (
    BARRIER_PHASE_RUNNING,
    OPERATOR_HUMAN,
    Answer,
    ArmState,
    Command,
    Model,
    Offer,
    Operator,
    RoomCamera,
    RoomStatus,
    State,
    TickStamps,
    pose_from_message,
    pose_message,
    raise_error,
)
from mart.protocol.messages import Seat as SeatMessage
from mart.protocol.tokens import Role, SeatToken, sign
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.sim.world.world import World
from mart.teleop_gateway.seat import Seat
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.settings import GatewaySettings
from tests.support.message_collector import MessageCollector
from tests.teleop_gateway.browser import Exchange, in_background

SECRET = b"s" * 32
_numbers = itertools.count(1)


class Room:
    """Its arm0 follows commands; nobody waits for anybody."""

    def __init__(self, bus: ZenohBus, world: World, model: Model) -> None:
        self.name = f"test-{next(_numbers)}"
        self.world = world
        self.tick_number = 0
        self.boot = 1
        self._newest: Command | None = None
        self._used = 0
        self._status = RoomStatus(room=self.name, barrier=BARRIER_PHASE_RUNNING, control_hz=model.control_hz)
        self._states = bus.publisher(keys.state(self.name))
        self._statuses = bus.publisher(keys.status(self.name))
        bus.serve(keys.model(self.name), lambda request: request.reply(codec.encode(model)))
        bus.subscribe(
            keys.command(self.name, "arm0").key, lambda s: self._keep(codec.decode(Command, s.payload))
        )

    def seat(self, epoch: int, operator: int = OPERATOR_HUMAN, arm: str = "arm0") -> None:
        """Who holds an arm, told to everyone."""
        others = [seat for seat in self._status.seats if seat.arm != arm]
        del self._status.seats[:]
        self._status.seats.extend(others)
        self._status.seats.append(SeatMessage(arm=arm, operator=Operator.Name(operator), epoch=epoch))
        self._statuses.put(codec.encode(self._status))

    def film(self, *cameras: str) -> None:
        """Cameras take the place of what is drawn."""
        self._status.cameras.extend(RoomCamera(camera=camera) for camera in cameras)
        self._statuses.put(codec.encode(self._status))

    def reset(self, seed: int) -> None:
        self.world.reset(seed)
        self._newest = None
        self._publish(None)

    def tick(self) -> None:
        actions = np.zeros((len(self.world.arms), 7))
        command = self._newest
        if command is not None:
            target = pose_from_message(command.target_tool_in_base)
            actions[0] = self.world.action_for("arm0", target, command.gripper)
        self.world.step(actions)
        self._publish(command)

    async def run(self) -> None:
        """At 20 Hz."""
        while True:
            self.tick()
            self._statuses.put(codec.encode(self._status))
            await asyncio.sleep(0.05)

    def _keep(self, command: Command) -> None:
        self._newest = command

    def _publish(self, command: Command | None) -> None:
        self.tick_number += 1
        now_ns = clock.wall_ns()
        arm = ArmState(arm="arm0", tool_in_base=pose_message(self.world.tool_pose_in_base("arm0")))
        if command is not None:
            arm.fresh = command.sequence > self._used
            arm.sequence = self._used = command.sequence
            arm.arrived_ns = command.stamps.sent_ns
            arm.stamps.CopyFrom(command.stamps)
        still = [
            ArmState(arm=seat.arm, tool_in_base=pose_message(self.world.tool_pose_in_base(seat.arm)))
            for seat in self._status.seats
            if seat.arm != "arm0"
        ]
        state = State(
            room=self.name,
            tick=self.tick_number,
            boot=self.boot,
            sim_time_s=self.world.sim_time_s,
            real_time_factor=1.0,
            integration_state=self.world.integration_state(),
            arms=[arm, *still],
            stamps=TickStamps(due_ns=now_ns, fired_ns=now_ns, stepped_ns=clock.wall_ns()),
        )
        self._states.put(codec.encode(state))


@dataclass
class SeatUnderTest:
    """A seat that runs in this process, and its room."""

    seat: Seat
    room: Room
    bus: AsyncBus
    arm: str = "arm0"

    def token(self, role: Role, **claims: object) -> str:
        given = {
            "room": self.room.name,
            "arm": self.arm,
            "epoch": 1,
            "role": role,
            "holder_id": "ana",
            "expires_s": clock.wall_ns() * 1e-9 + 60,
            **claims,
        }
        return sign(SeatToken(**given), SECRET)  # type: ignore[arg-type]

    def exchange(self, role: Role, token: str | None = None) -> Exchange:
        """Signals over the bus, as the web service does."""

        async def exchange(sdp: str) -> str:
            offer = Offer(token=self.token(role) if token is None else token, sdp=sdp)
            return (await self.offer(role, codec.encode(offer))).sdp

        return exchange

    async def offer(self, role: Role, payload: bytes) -> Answer:
        reply = await self.bus.query(keys.signal(self.room.name, self.arm, role), payload, 10.0)
        answer = codec.decode(Answer, reply)
        raise_error(answer.error)
        return answer

    def commands(self) -> MessageCollector[Command]:
        return MessageCollector(self.bus.bus, keys.command(self.room.name, "arm0").key, Command)


@contextlib.asynccontextmanager
async def running_seat(router: str, world: World, model: Model) -> AsyncIterator[SeatUnderTest]:
    """A seat of epoch 1 that answers offers, in a room that ticks."""
    loop = asyncio.get_running_loop()
    with (
        ZenohBus.connect(router) as mine,
        ZenohBus.connect(router) as seats,
        ZenohBus.connect(router) as video,
    ):
        room = Room(mine, world, model)
        settings = GatewaySettings(router=router)
        seat = Seat(AsyncBus(seats, loop), video, settings, SeatAddress(room.name, "arm0"), SECRET)
        async with in_background(seat.run()), in_background(room.run()):
            await asyncio.sleep(0)  # both have begun
            room.seat(epoch=1)
            yield SeatUnderTest(seat, room, AsyncBus(mine, loop))


@contextlib.asynccontextmanager
async def beside(first: SeatUnderTest, router: str, arm: str) -> AsyncIterator[SeatUnderTest]:
    """Another seat of the same room, of epoch 1, with connections to the bus of its own."""
    loop = asyncio.get_running_loop()
    with ZenohBus.connect(router) as seats, ZenohBus.connect(router) as video:
        address = SeatAddress(first.room.name, arm)
        seat = Seat(AsyncBus(seats, loop), video, GatewaySettings(router=router), address, SECRET)
        async with in_background(seat.run()):
            await asyncio.sleep(0)
            first.room.seat(epoch=1, arm=arm)
            yield SeatUnderTest(seat, first.room, first.bus, arm)


Body = Callable[[SeatUnderTest], Awaitable[None]]
OnSeat = Callable[[Body], None]
