"""The gateway's processes: there when a seat is claimed, back after a crash, gone with the seat or the gateway."""

from __future__ import annotations

import asyncio
import contextlib
import os
import select
import signal
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from pathlib import Path

import pytest

from mart.protocol import clock, codec, keys, tokens
from mart.protocol.errors import Unavailable
from mart.protocol.messages import (
    OPERATOR_HUMAN,
    Answer,
    Event,
    Offer,
    OpenSeat,
    OpenSeatReply,
    RoomReply,
    SeatRequest,
    State,
    raise_error,
)
from mart.protocol.tokens import Role, SeatToken
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.secret_file import load_or_create_secret
from mart.teleop_gateway.emulation.emulated_phone import EmulatedPhone
from mart.teleop_gateway.emulation.network_emulation import LinkProfile
from tests.support.message_collector import MessageCollector
from tests.support.processes import Running, running_router, running_service
from tests.teleop_gateway.browser import Exchange, connected, in_background

pytestmark = pytest.mark.system

ROOM = "room-1"


class Platform:
    """A router, a room and a gateway as processes, and a bus to talk to them."""

    def __init__(self, endpoint: str, gateway: Running, data_dir: Path) -> None:
        self.endpoint, self.gateway = endpoint, gateway
        self._secret = load_or_create_secret(data_dir / "secrets" / "seat-token")

    @contextlib.asynccontextmanager
    async def bus(self) -> AsyncIterator[AsyncBus]:
        with ZenohBus.connect(self.endpoint) as bus:
            yield AsyncBus(bus, asyncio.get_running_loop())

    async def claim(self, bus: AsyncBus, arm: str = "arm0") -> int:
        """Takes the seat for Ana; its epoch."""
        claim = SeatRequest.Claim(arm=arm, holder_id="ana", name="Ana", operator=OPERATOR_HUMAN)
        return (await self._ask_seat(bus, SeatRequest(claim=claim))).seat.epoch

    async def release(self, bus: AsyncBus, arm: str = "arm0") -> None:
        await self._ask_seat(bus, SeatRequest(release=SeatRequest.Release(arm=arm, holder_id="ana")))

    async def open(self, bus: AsyncBus, arm: str = "arm0", epoch: int = 0) -> None:
        opening = codec.encode(OpenSeat(room=ROOM, arm=arm, seat_epoch=epoch))
        raise_error(
            codec.decode(OpenSeatReply, await bus.query(keys.open_seat("gateway-1"), opening, 60)).error
        )

    def exchange(self, bus: AsyncBus, role: Role, epoch: int, arm: str = "arm0") -> Exchange:
        async def exchange(sdp: str) -> str:
            await self.open(bus, arm, epoch)
            token = SeatToken(ROOM, arm, epoch, role, "ana", clock.wall_ns() * 1e-9 + 60)
            offer = codec.encode(Offer(token=tokens.sign(token, self._secret), sdp=sdp))
            answer = codec.decode(Answer, await bus.query(keys.signal(ROOM, arm, role), offer, 60))
            raise_error(answer.error)
            return answer.sdp

        return exchange

    async def _ask_seat(self, bus: AsyncBus, request: SeatRequest) -> RoomReply:
        reply = codec.decode(RoomReply, await bus.query(keys.seat(ROOM), codec.encode(request), 10))
        raise_error(reply.error)
        return reply


Body = Callable[[Platform, AsyncBus], Awaitable[None]]


@contextlib.contextmanager
def running_platform(data_dir: Path) -> Iterator[Platform]:
    with (
        running_router() as endpoint,
        running_service(
            ["sim", "--room", ROOM, "--control-hz", "20"], endpoint, data_dir, kind="sim", id=ROOM
        ),
        running_service(["gateway"], endpoint, data_dir, kind="gateway", id="gateway-1") as gateway,
    ):
        yield Platform(endpoint, gateway, data_dir)


@pytest.fixture(scope="module")
def shared_platform(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Platform]:
    with running_platform(tmp_path_factory.mktemp("platform")) as running:
        yield running


@pytest.fixture
def platform(shared_platform: Platform) -> Iterator[Platform]:
    """Whose seat is free again after the test."""
    yield shared_platform
    on_platform(shared_platform, lambda platform, bus: platform.release(bus))


@pytest.fixture
def own_platform(tmp_path: Path) -> Iterator[Platform]:
    """For a gateway that does not survive the test."""
    with running_platform(tmp_path) as running:
        yield running


def on_platform(platform: Platform, body: Body) -> None:
    async def main() -> None:
        async with asyncio.timeout(90), platform.bus() as bus:
            await body(platform, bus)

    asyncio.run(main())


def children(pid: int) -> set[int]:
    """Processes that this process started and that still run."""
    return {int(process) for process in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()}


def serving(gateway: Running, arm: str = "arm0") -> int:
    """The process that serves a seat, from the log: the last one that was said to."""
    lines = [line for line in gateway.log().splitlines() if f"{ROOM} {arm} is served by process" in line]
    return int(lines[-1].rsplit(" ", 1)[-1])


def test_a_claim_is_served_by_a_warm_process(platform: Platform) -> None:
    async def body(platform: Platform, bus: AsyncBus) -> None:
        epoch = await platform.claim(bus)
        await platform.open(bus)
        await platform.release(bus)
        await bus.query(keys.model(ROOM), b"", 60)
        epoch = await platform.claim(bus)  # by now a spare is warm
        async with connected(platform.exchange(bus, Role.BROWSER, epoch)) as browser:
            ticks = [await browser.next_tick() for _ in range(3)]
            assert all(tick is not None for tick in ticks)

    on_platform(platform, body)


def test_a_seat_that_is_left_while_it_is_watched_ends_quietly(platform: Platform) -> None:
    async def body(platform: Platform, bus: AsyncBus) -> None:
        epoch = await platform.claim(bus)
        async with (
            connected(platform.exchange(bus, Role.BROWSER, epoch)) as browser,
            connected(platform.exchange(bus, Role.PHONE, epoch), Role.PHONE),
        ):
            await browser.next_tick()
            process = os.pidfd_open(serving(platform.gateway))
            await platform.release(bus)
            ended, _, _ = await asyncio.to_thread(select.select, [process], [], [], 10)
            assert ended

    on_platform(platform, body)
    log = platform.gateway.log()
    for symptom in ("Traceback", "was destroyed", "never retrieved", "Undeclared"):
        assert symptom not in log, log


def test_a_seat_that_nobody_holds_cannot_be_opened(platform: Platform) -> None:
    async def body(platform: Platform, bus: AsyncBus) -> None:
        with pytest.raises(Unavailable):
            await platform.open(bus, "arm1")

    on_platform(platform, body)


def test_garbage_is_answered_in_words(platform: Platform) -> None:
    async def body(platform: Platform, bus: AsyncBus) -> None:
        for garbage in (b"\xff" * 10, b"x" * 5000):
            reply = codec.decode(OpenSeatReply, await bus.query(keys.open_seat("gateway-1"), garbage, 10))
            assert reply.error.code == "InvalidInput"
        with contextlib.closing(bus.publisher(keys.status(ROOM))) as statuses:
            statuses.put(b"\xff" * 10)
        await platform.claim(bus)
        await platform.open(bus)
        assert "10 bytes were given that are not a RoomStatus. (1 so far)" in platform.gateway.log()
        assert "Traceback" not in platform.gateway.log()

    on_platform(platform, body)


def test_a_killed_seat_is_told_and_comes_back_and_the_phone_goes_on(platform: Platform) -> None:
    async def body(platform: Platform, bus: AsyncBus) -> None:
        epoch = await platform.claim(bus)
        phone = EmulatedPhone(
            bus,
            platform.exchange(bus, Role.PHONE, epoch),
            room=ROOM,
            arm="arm0",
            seat_epoch=epoch,
            link=LinkProfile(delay_s=0.005, jitter_s=0.005, loss=0.01),
        )
        with (
            MessageCollector(bus.bus, keys.event(ROOM).key, Event) as events,
            MessageCollector(bus.bus, keys.state(ROOM).key, State) as states,
        ):
            async with in_background(phone.run()):
                before = await asyncio.to_thread(states.wait_for, lambda s: s.arms[0].sequence > 0, 30)
                os.kill(serving(platform.gateway), signal.SIGKILL)
                killed_s = clock.monotonic_s()
                notice = await asyncio.to_thread(events.wait_for, lambda e: e.HasField("notice"))
                assert clock.monotonic_s() - killed_s < 1.0
                assert notice.notice.text == "The link of arm0 broke and is being restored."
                assert getattr(notice.notice, "from") == "gateway/gateway-1"
                # Newer sequence numbers than the killed process's, or the sim would not take them.
                since = len(states)
                after = await asyncio.to_thread(
                    states.wait_for, lambda s: s.arms[0].fresh and s.tick > before.tick, 30, since
                )
                assert after.arms[0].sequence > before.arms[0].sequence

    on_platform(platform, body)


def test_processes_end_with_the_seat_and_with_the_gateway(own_platform: Platform) -> None:
    async def body(platform: Platform, bus: AsyncBus) -> None:
        gone = asyncio.Event()
        seen: list[bool] = []

        def on_token(_key: str, alive: bool) -> None:
            seen.append(alive)
            if seen[:2] == [True, False]:
                gone.set()

        with contextlib.closing(bus.watch(keys.alive(ServiceKind.SEAT, f"{ROOM}-arm0"), on_token)):
            await platform.claim(bus)
            await platform.open(bus)
            await platform.release(bus)
            await asyncio.wait_for(gone.wait(), 30)

    on_platform(own_platform, body)
    pids = children(own_platform.gateway.process.pid)
    assert pids
    own_platform.gateway.terminate()
    assert not any(Path(f"/proc/{pid}").exists() for pid in pids)


def test_seat_processes_do_not_outlive_a_killed_gateway(own_platform: Platform) -> None:
    async def body(platform: Platform, bus: AsyncBus) -> None:
        ended = asyncio.Event()
        await platform.claim(bus)
        await platform.open(bus)

        def on_token(_key: str, alive: bool) -> None:
            if not alive:
                ended.set()

        with contextlib.closing(bus.watch(keys.alive(ServiceKind.SEAT, f"{ROOM}-arm0"), on_token)):
            platform.gateway.kill()
            await asyncio.wait_for(ended.wait(), 30)

    on_platform(own_platform, body)
