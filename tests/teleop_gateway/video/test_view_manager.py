"""There is a view of the newest model, however the models before it came and went."""

from __future__ import annotations

import asyncio
import threading
from typing import Any

import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import Model, State
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.video import view_manager
from mart.teleop_gateway.video.page_drawing import PageDrawing
from mart.teleop_gateway.video.quality import FAST
from mart.teleop_gateway.video.view_manager import ViewManager

SEAT = SeatAddress("room-1", "arm0")


class StubView:
    """A view that takes its time to end."""

    def __init__(self, model: str, *_: object) -> None:
        self.model = model
        self.states: list[State] = []
        self.stopping = asyncio.Event()
        self.may_stop = threading.Event()
        self._loop = asyncio.get_running_loop()

    def set_streams(self, limits_bps: object) -> None:
        pass

    def set_resting(self, resting: bool) -> None:
        pass

    def start(self) -> None:
        pass

    def offer(self, state: State, received_ns: int) -> None:
        self.states.append(state)

    def stop(self) -> None:
        self._loop.call_soon_threadsafe(self.stopping.set)
        assert self.may_stop.wait(20)


class Room:
    """Sends a model to whoever asks, and holds the views that were made of them."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.model = "first"
        self.made: list[StubView] = []
        network = MemoryNetwork()
        network.connect().serve(
            keys.model(SEAT.room), lambda request: request.reply(codec.encode(Model(sha256=self.model)))
        )
        monkeypatch.setattr(view_manager, "load_plain_model", lambda message: message.sha256)
        monkeypatch.setattr(view_manager, "drawn_model", lambda model, quality: model)
        monkeypatch.setattr(view_manager, "world_painter", lambda model, *_: model)
        monkeypatch.setattr(view_manager, "camera_azimuth_rad", lambda model, arm: 0.0)
        monkeypatch.setattr(view_manager, "LiveView", self._make)
        self.used = asyncio.Event()
        self.views = ViewManager(
            AsyncBus(network.connect(), asyncio.get_running_loop()),
            SEAT,
            sink=lambda _: None,
            on_azimuth=lambda _: self.used.set(),
            quality=FAST,
            pages=PageDrawing(asyncio.get_running_loop(), lambda _: None),
        )

    def _make(self, *arguments: Any, **_: object) -> StubView:
        view = StubView(*arguments)
        self.made.append(view)
        return view

    async def boots(self, boot: int) -> None:
        """Return when a model of this run is used."""
        self.used.clear()
        self.views.on_boot(boot)
        await self.used.wait()


def run(body: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    async def main() -> None:
        async with asyncio.timeout(30):
            await body(Room(monkeypatch))

    asyncio.run(main())


def test_a_run_with_the_same_model_keeps_its_view(monkeypatch: pytest.MonkeyPatch) -> None:
    async def body(room: Room) -> None:
        await room.boots(1)
        room.views.on_boot(2)
        fetching = room.views._fetching
        assert fetching is not None
        await fetching
        assert len(room.made) == 1
        room.views.offer(State(tick=3), 0)
        assert [state.tick for state in room.made[0].states] == [3]
        room.made[0].may_stop.set()
        await room.views.close()

    run(body, monkeypatch)


def test_a_change_of_model_that_is_taken_back_half_way_leaves_a_view(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first view is ending when the sim starts once more, with the first model again."""

    async def body(room: Room) -> None:
        await room.boots(1)
        room.model = "second"
        room.views.on_boot(2)
        await room.made[0].stopping.wait()
        room.model = "first"
        again = asyncio.create_task(room.boots(3))
        await asyncio.sleep(0)  # it has begun, and taken back what the second run began
        room.made[0].may_stop.set()
        await again
        room.views.offer(State(tick=7), 0)
        assert [state.tick for state in room.made[2].states] == [7]
        assert room.made[2].model == "first"
        room.made[2].may_stop.set()
        await room.views.close()

    run(body, monkeypatch)
