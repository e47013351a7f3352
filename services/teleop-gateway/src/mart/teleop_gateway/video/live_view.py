"""Paint and encode one seat's picture once for everyone who watches, on a thread of its own.

Newest wins before the encoder: a slow renderer leaves states out. After it nothing may be left out, since every
picture builds on the one before; see `track`. Pictures that take too long are drawn smaller; see `adaptive_resolution`.
"""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from statistics import median

import cv2

from mart.protocol import clock
from mart.protocol.errors import Corrupt, InvalidInput, MartError
from mart.protocol.messages import State
from mart.render import Image
from mart.runtime.rate_limit import RateLimit
from mart.runtime.watchdog import end_process, start_vital_thread
from mart.teleop_gateway.video.adaptive_resolution import AdaptiveResolution, at_full_size
from mart.teleop_gateway.video.encoder import RECORDED, EncodedPicture, Stream
from mart.teleop_gateway.video.motion_to_photon import PictureStamps
from mart.teleop_gateway.video.picture_painter import MakePainter, PicturePainter, UnpaintedPicture
from mart.teleop_gateway.video.quality import FAST, Quality
from mart.teleop_gateway.video.render_queue import RenderQueue, RenderQueueClosed
from mart.teleop_gateway.video.seat_metrics import ENCODE, RENDER
from mart.teleop_gateway.video.stream_encoders import StreamEncoders
from mart.teleop_gateway.video.thumbnail import EVERY_S, Thumbnail, ThumbnailMaker

_log = logging.getLogger(__name__)

_REPEAT_AFTER_S = 0.5  # a resting world is sent again: whoever lost the last picture gets it
_KEYFRAME_WITHIN_S = 0.05
_RATE_WINDOW = 40


@dataclass(frozen=True)
class SeatPicture:
    """Hold one encoded picture on its way to peers and bus. `image_ns` is when the world was in this state."""

    encoded: EncodedPicture
    tick: int
    image_ns: int
    stamps: PictureStamps


Sink = Callable[[SeatPicture | Thumbnail], None]


class _RenderPipeline:
    """Hold what a picture of one size takes: a painter, encoders, and the picture itself."""

    def __init__(self, painter: PicturePainter, quality: Quality, frames_per_s: float) -> None:
        self._painter, self._full, self._frames_per_s = painter, quality, frames_per_s
        self._prepare(quality)

    def resize(self, size: Fraction) -> None:
        """Draw at this share of the full width. The first picture of another size is a keyframe."""
        quality = self._full.sized(size)
        if quality != self._quality:
            self._painter.resize(quality)
            self._prepare(quality)

    def paint(self, unpainted: UnpaintedPicture) -> None:
        """Fill the picture."""
        self._painter.paint(unpainted, self.picture_rgb)

    @property
    def view_rgb(self) -> Image:
        """Return the picture without the strip."""
        return self.picture_rgb[: self._quality.view_height_px]

    def close(self) -> None:
        """Give back what the painter holds."""
        self._painter.close()

    def _prepare(self, quality: Quality) -> None:
        self._quality = quality
        self.picture_rgb = quality.blank_picture()
        self.encoders = StreamEncoders(self._frames_per_s, quality)


class LiveView:
    """Paint the seat of `arm` from `start` to `stop`. The sink is called on its thread: it may only hand over.

    make_painter: called on the same thread; where it raises a MartError, that is the `failure`.
    """

    def __init__(
        self,
        make_painter: MakePainter,
        arm: str,
        frames_per_s: float,
        sink: Sink,
        quality: Quality = FAST,
        *,
        end: Callable[[str], None] = end_process,
    ) -> None:
        self._make_painter, self._arm, self._sink, self._quality = make_painter, arm, sink, quality
        self._frames_per_s = frames_per_s
        self._queue = RenderQueue()
        self._streams: Mapping[Stream, float] = {}
        self._log_limit = RateLimit(1)
        self._times_s: deque[float] = deque(maxlen=_RATE_WINDOW)
        self._took_s: deque[float] = deque(maxlen=_RATE_WINDOW)  # as at full size
        self.failure = ""  # why nothing can be drawn, in a sentence
        self._end = end
        self._resting = False
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Begin to draw, on a thread of its own. Where that fails, the process ends: nobody may drive blind."""
        self._thread = start_vital_thread(self._run, f"view-{self._arm}", self._end)

    def stop(self) -> None:
        """Return when the thread has ended."""
        self._queue.close()
        if self._thread is not None:
            self._thread.join()

    def offer(self, state: State, received_ns: int) -> None:
        """Draw this state next, in the place of one that is not drawn yet. `received_ns` is when it came here."""
        self.show(UnpaintedPicture.of(state, received_ns))

    def show(self, unpainted: UnpaintedPicture) -> None:
        """Paint this next, in the place of what is not painted yet."""
        self._queue.offer(unpainted)

    def set_streams(self, limits_bps: Mapping[Stream, float]) -> None:
        """Make these streams, with so many bits a second; infinity without a limit. The recorded one is always made."""
        self._streams = limits_bps
        self._queue.set_streams(limits_bps)

    def set_resting(self, resting: bool) -> None:
        """Draw thumbnails alone; or draw every state again, from a keyframe on."""
        self._resting = resting
        if not resting:
            for stream in {RECORDED, *self._streams}:
                self._queue.request_keyframe(stream)

    def request_keyframe(self, stream: Stream) -> None:
        """Make the next picture of this stream a keyframe."""
        self._queue.request_keyframe(stream)

    def frames_per_s(self) -> float:
        """Return the rate of the last pictures; 0 where nothing was drawn for a second."""
        times_s = tuple(self._times_s)
        if len(times_s) < 2 or clock.monotonic_s() - times_s[-1] > 1.0:
            return 0.0
        return (len(times_s) - 1) / (times_s[-1] - times_s[0])

    def picture_s(self) -> float:
        """Return what a state's picture takes of a core, drawn and encoded at full size; 0 where there are none.

        The median, or at rest the share of it that thumbnails are.
        """
        took_s = tuple(self._took_s)
        if self._resting:
            return median(took_s) / max(1.0, EVERY_S * self._frames_per_s) if took_s else 0.0
        return median(took_s) if took_s and self.frames_per_s() else 0.0

    def _run(self) -> None:
        cv2.setNumThreads(1)
        try:
            painter = self._make_painter(self._quality)
            pipeline = _RenderPipeline(painter, self._quality, self._frames_per_s)
        except MartError as error:
            _log.error("%s gets no picture: %s", self._arm, error)  # the sentence says it all
            self.failure = str(error)
            return
        try:
            self._draw_until_closed(pipeline)
        except RenderQueueClosed:
            _log.debug("The view of %s ends", self._arm)
        finally:
            pipeline.close()

    def _draw_until_closed(self, pipeline: _RenderPipeline) -> None:
        resolution, thumbnails = AdaptiveResolution(self._frames_per_s), ThumbnailMaker()
        drawn: UnpaintedPicture | None = None
        rendered_ns, size = 0, resolution.size
        while True:
            undrawn = self._queue.wait(_REPEAT_AFTER_S, _KEYFRAME_WITHIN_S)
            begun_s, begun_cpu_s = clock.monotonic_s(), clock.thread_cpu_s()
            if self._resting and not thumbnails.is_due(begun_s):
                drawn = None  # what is sent again must not be older than what pages have drawn
                continue
            if undrawn is not None:
                size = resolution.size
                pipeline.resize(size)
                try:
                    pipeline.paint(undrawn)
                except (InvalidInput, Corrupt) as error:
                    if self._log_limit.allows(begun_s):
                        _log.warning("A picture was not painted: %s", error)
                    continue
                drawn, rendered_ns = undrawn, clock.wall_ns()
                self._times_s.append(clock.monotonic_s())
                RENDER.observe(clock.monotonic_s() - begun_s)
            if drawn is not None and not self._resting:
                with ENCODE.time():
                    self._encode(pipeline, drawn, rendered_ns)
            if undrawn is not None:
                now_s = clock.monotonic_s()
                self._took_s.append(at_full_size(clock.thread_cpu_s() - begun_cpu_s, size))
                resolution.record(now_s - begun_s, now_s)
                thumbnail = thumbnails.take(pipeline.view_rgb, undrawn.image_ns, now_s)
                if thumbnail is not None:
                    self._sink(thumbnail)

    def _encode(self, pipeline: _RenderPipeline, drawn: UnpaintedPicture, rendered_ns: int) -> None:
        limits_bps, wanted = self._queue.take_orders()
        now_s = clock.monotonic_s()
        for encoded in pipeline.encoders.encode(pipeline.picture_rgb, now_s, limits_bps, wanted):
            stamps = PictureStamps(drawn.received_ns, rendered_ns, clock.wall_ns())
            self._sink(SeatPicture(encoded, drawn.tick, drawn.image_ns, stamps))
