"""Follow the cameras that one seat can show, and bring the pictures of the chosen one to its view.

Pictures come on the bus's thread; everything else happens on the event loop.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import replace

from mart.protocol import clock, keys
from mart.protocol.cameras import camera_in_words, camera_title, cameras_of_seat
from mart.protocol.messages import CameraFrame, RoomStatus, State
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Closable
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.video.picture_painter import CapturedPicture, UnpaintedPicture
from mart.teleop_gateway.video.tick_times import TickTimes

OLD_AFTER_S = 1.0  # a picture older than this says so
_LOOK_EVERY_S = 0.25
_LONGEST_TRIP_S = 1.0  # on the bus; clocks that differ by more, or the wrong way, say nothing


def age_at_arrival_s(frame: CameraFrame, received_ns: int) -> float:
    """Return how old a picture was when it came here: what its sender says, and its way where both clocks agree."""
    sent_ns = frame.captured_ns + round(1e9 * frame.age_s)
    trip_s = (received_ns - sent_ns) * 1e-9
    return max(0.0, frame.age_s) + (trip_s if 0.0 <= trip_s <= _LONGEST_TRIP_S else 0.0)


class CameraFeed:
    """Hold which cameras there are and which one is shown; nothing at a seat without any."""

    def __init__(
        self,
        bus: AsyncBus,
        seat: SeatAddress,
        show: Callable[[UnpaintedPicture], None],
        on_filmed: Callable[[bool], None],
    ) -> None:
        """Give pictures to `show`, and tell `on_filmed` whether the seat has cameras whenever that changes."""
        self.names: tuple[str, ...] = ()
        self.shown = ""
        self._bus, self._seat, self._show, self._on_filmed = bus, seat, show, on_filmed
        self._ticks = TickTimes()
        self._dark: dict[str, str] = {}  # what the room says of each
        self._subscription: Closable | None = None
        self._newest: UnpaintedPicture | None = None
        self._captured_s = clock.monotonic_s()  # the newest; before it, when the camera was chosen

    @property
    def is_filmed(self) -> bool:
        """Whether a camera takes the place of what is drawn."""
        return bool(self.names)

    def close(self) -> None:
        """Follow no camera any more."""
        if self._subscription is not None:
            self._subscription.close()
            self._subscription = None

    def on_state(self, state: State) -> None:
        """Take a tick. Call it as soon as it comes, on any thread."""
        self._ticks.add(state.tick, state.boot, clock.monotonic_s())

    def on_status(self, status: RoomStatus) -> None:
        """Take which cameras the room has, and how they do."""
        names = cameras_of_seat((one.camera for one in status.cameras), self._seat.arm)
        self._dark = {one.camera: one.dark for one in status.cameras}
        if names != self.names:
            self.names = names
            self._on_filmed(bool(names))
            if self.shown not in names:
                self._choose(names[0] if names else "")

    def choose(self, camera: str) -> bool:
        """Show the camera with this id from now on; returns whether the seat has it."""
        if camera in self.names and camera != self.shown:
            self._choose(camera)
        return camera in self.names

    def darkness(self, now_s: float) -> str:
        """Return why the picture is old, in a sentence; empty where it is not, and at a seat without a camera."""
        if not self.shown or now_s - self._captured_s <= OLD_AFTER_S:
            return ""
        why = self._dark.get(self.shown) or "No picture of it comes here."
        name = camera_in_words(self.shown)
        return f"{name[0].upper()}{name[1:]}: {why[0].lower()}{why[1:]}"

    async def run(self) -> None:
        """Say on an old picture that it is old, until cancelled."""
        while True:
            await asyncio.sleep(_LOOK_EVERY_S)
            now_s = clock.monotonic_s()
            if self.darkness(now_s):
                self._show(self._noticed(now_s))

    def _noticed(self, now_s: float) -> UnpaintedPicture:
        """Return the newest picture with words about its age: of the same tick, for nothing newer is seen."""
        text = f"{camera_title(self.shown)}: no picture for {now_s - self._captured_s:.0f} s"
        newest = self._newest
        if newest is None or not isinstance(newest.content, CapturedPicture):
            now_ns = clock.wall_ns()
            return UnpaintedPicture(CapturedPicture(b"", text), 0, now_ns, now_ns)
        return replace(newest, content=replace(newest.content, notice=text))

    def _choose(self, camera: str) -> None:
        self.close()
        self.shown, self._newest, self._captured_s = camera, None, clock.monotonic_s()
        if camera:
            key = keys.camera_frame(self._seat.room, camera).key
            # Not over the event loop: the view's thread must have a picture before the loop finds time for it.
            self._subscription = self._bus.bus.subscribe(key, DecodingSubscriber(CameraFrame, self._on_frame))

    def _on_frame(self, frame: CameraFrame) -> None:
        received_ns, received_s = clock.wall_ns(), clock.monotonic_s()
        age_s = age_at_arrival_s(frame, received_ns)
        captured_s = received_s - age_s
        if frame.camera != self.shown or (self._newest is not None and captured_s <= self._captured_s):
            return  # of the camera before, or overtaken
        captured_ns = received_ns - round(1e9 * age_s)
        content = CapturedPicture(frame.jpeg)
        self._newest = UnpaintedPicture(content, self._ticks.tick_at(captured_s), captured_ns, captured_ns)
        self._captured_s = captured_s
        self._show(self._newest)
