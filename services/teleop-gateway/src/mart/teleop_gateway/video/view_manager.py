"""Fetch the room's model once for each run of its sim, and hold the view that draws it."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Mapping

from mart.protocol import keys
from mart.protocol.errors import MartError
from mart.protocol.keys import DETAILED
from mart.protocol.messages import Model, State
from mart.protocol.received import decode_received
from mart.runtime.bus.aio import AsyncBus
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.video.captured_pictures import PICTURES_PER_S
from mart.teleop_gateway.video.encoder import Stream
from mart.teleop_gateway.video.live_view import LiveView, Sink
from mart.teleop_gateway.video.page_drawing import PageDrawing
from mart.teleop_gateway.video.picture_painter import CameraPainter, UnpaintedPicture, world_painter
from mart.teleop_gateway.video.quality import Quality
from mart.teleop_gateway.video.seat_renderer import (
    camera_azimuth_rad,
    drawn_model,
    ghosts_for,
    load_plain_model,
    task_of,
)
from mart.teleop_gateway.video.tool_projection import ToolPlaces, ToolProjection, ToolView

_log = logging.getLogger(__name__)

_QUERY_TIMEOUT_S = 5.0
_RETRY_S = 0.5
_RETRY_AFTER_FAILURE_S = 5.0


class ViewManager:
    """Hold the view of the room's newest model. States come from any thread; `sink` is called on the view's thread.

    `on_azimuth` is called on the event loop with the azimuth of the seat's camera whenever there is a new model.
    """

    def __init__(
        self,
        bus: AsyncBus,
        seat: SeatAddress,
        *,
        sink: Sink,
        on_azimuth: Callable[[float], None],
        quality: Quality,
        pages: PageDrawing,
    ) -> None:
        self._pages = pages
        self._resting = False
        self._bus, self._seat = bus, seat
        self._sink, self._on_azimuth, self._quality = sink, on_azimuth, quality
        self._filmed = False
        self._boot = 0
        self._sha256 = ""
        self._limits_bps: Mapping[Stream, float] = {}
        self._view: LiveView | None = None
        self._projection: ToolProjection | None = None
        self._fetching: asyncio.Task[None] | None = None
        self._stopping: asyncio.Future[None] | None = None  # the view before

    def offer(self, state: State, received_ns: int) -> None:
        """Draw this state next. Call it on any thread."""
        view = self._view
        if view is not None and not self._filmed:
            view.offer(state, received_ns)

    def show(self, captured: UnpaintedPicture) -> None:
        """Show this picture of a camera next. Call it on any thread."""
        view = self._view
        if view is not None and self._filmed:
            view.show(captured)

    def film(self, filmed: bool) -> None:
        """Show pictures of cameras from now on, or draw. Call it on the event loop."""
        if filmed == self._filmed:
            return
        self._filmed, self._sha256 = filmed, ""
        self._pages.film(filmed)
        if self._boot:
            self._begin_fetching()

    def on_boot(self, boot: int) -> None:
        """Take that the sim has started anew, perhaps with another model. Call it on the event loop."""
        if boot == self._boot:
            return
        self._boot = boot
        self._begin_fetching()

    def _begin_fetching(self) -> None:
        if self._fetching is not None:
            self._fetching.cancel()
        self._fetching = self._bus.spawn(self._fetch())

    def set_streams(self, limits_bps: Mapping[Stream, float]) -> None:
        """Make these streams, with so many bits a second, now and in every later view."""
        self._limits_bps = dict(limits_bps)
        if self._view is not None:
            self._view.set_streams(self._limits_bps)

    def set_resting(self, resting: bool) -> None:
        """Draw nothing but thumbnails, now and in every later view, because nobody needs the pictures; or draw on."""
        if resting != self._resting:
            self._resting = resting
            if self._view is not None:
                self._view.set_resting(resting)

    def request_keyframe(self, stream: Stream) -> None:
        """Make the next picture of this stream a keyframe."""
        if self._view is not None:
            self._view.request_keyframe(stream)

    def frames_per_s(self) -> float:
        """Return the rate of the last pictures; 0 where there are none."""
        return self._view.frames_per_s() if self._view is not None else 0.0

    def picture_s(self) -> float:
        """Return what a picture takes, drawn and encoded at full size; 0 where there are none."""
        return self._view.picture_s() if self._view is not None else 0.0

    def failure(self) -> str:
        """Return why nothing can be drawn, in a sentence; empty where it can, or nothing is known yet."""
        return self._view.failure if self._view is not None else ""

    def tool_places(self, state: State) -> ToolPlaces:
        """Return where in the picture of this state the tools are; nothing where there is no model yet."""
        return self._projection.places(state) if self._projection is not None else {}

    def tool_view(self, state: State) -> ToolView | None:
        """Return what it takes to draw near the seat's own tool into the picture; None where there is no model yet."""
        return self._projection.view_of(self._seat.arm, state) if self._projection is not None else None

    async def close(self) -> None:
        """Return when no picture will come any more."""
        if self._fetching is not None:
            self._fetching.cancel()
        await self._replace(None)
        if self._stopping is not None:  # where the fetching was replacing a view just then
            await self._stopping

    async def _fetch(self) -> None:
        while True:
            try:
                answer = await self._bus.query(keys.model(self._seat.room), self._wanted(), _QUERY_TIMEOUT_S)
                message = decode_received(Model, answer)
                if message.sha256 != self._sha256:
                    await self._use(message)
            except MartError as error:
                _log.warning("No picture of %s yet: %s", self._seat.room, error)
                await asyncio.sleep(_RETRY_S)
            except Exception:  # noqa: BLE001 - logged whole; a room without a picture is asked again
                _log.exception("No picture of %s yet: its model could not be used", self._seat.room)
                await asyncio.sleep(_RETRY_AFTER_FAILURE_S)
            else:
                return

    def _wanted(self) -> bytes:
        return DETAILED if self._quality.detailed else b""

    async def _use(self, message: Model) -> None:
        model = await asyncio.to_thread(load_plain_model, message)
        azimuth_rad = camera_azimuth_rad(model, self._seat.arm)
        task, arm = task_of(message), self._seat.arm
        self._pages.use(model, task)
        # Where a real camera hangs is not known, so nothing can be written into its picture.
        drawn_task = None if self._filmed else task
        self._projection = ToolProjection.of(model, drawn_task, arm) if drawn_task is not None else None
        if self._filmed:
            view = LiveView(CameraPainter, arm, PICTURES_PER_S, self._sink, self._quality)
        else:
            painter = world_painter(drawn_model(model, self._quality), arm, ghosts_for(task, arm))
            view = LiveView(painter, arm, message.control_hz, self._sink, self._quality)
        view.set_streams(self._limits_bps)
        view.set_resting(self._resting)
        # Where this is cancelled half-way, no model is drawn: the next one that is fetched must be used.
        self._sha256 = ""
        await self._replace(view)
        self._sha256 = message.sha256
        self._on_azimuth(azimuth_rad)

    async def _replace(self, view: LiveView | None) -> None:
        before, self._view = self._view, None
        if before is not None:
            self._stopping = asyncio.ensure_future(asyncio.to_thread(before.stop))
            await asyncio.shield(self._stopping)
        if view is not None:
            view.start()
        self._view = view
