"""The picture of one seat: rendered and encoded once, handed to everyone who watches. A thread of its own.

Newest wins before the encoder: a slow renderer leaves states out. After it nothing may be left out, since every
picture builds on the one before; see `track`. Pictures that take too long are drawn smaller; see `sizing`.
"""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from fractions import Fraction

import cv2
import mujoco

from mart.protocol import clock
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import State
from mart.runtime.rate_limit import RateLimit
from mart.teleop_gateway.encoder import CLOCK_HZ, Codec, Encoded, Encoder, to_i420
from mart.teleop_gateway.handover import Closed, Fresh, Handover
from mart.teleop_gateway.latency import PictureStamps
from mart.teleop_gateway.quality import FAST, Image, Quality
from mart.teleop_gateway.renderer import Renderer
from mart.teleop_gateway.sizing import Sizing
from mart.teleop_gateway.still import Still, Stills

_log = logging.getLogger(__name__)

KEYFRAME_EVERY_S = 2.0
_REPEAT_AFTER_S = 0.5  # a resting world is sent again: whoever lost the last picture gets it
_KEYFRAME_WITHIN_S = 0.05
_RATE_WINDOW = 40


@dataclass(frozen=True)
class Picture:
    """One encoded picture on its way to the peers and onto the bus. image_ns: when the world was in this state."""

    encoded: Encoded
    tick: int
    image_ns: int
    stamps: PictureStamps


Sink = Callable[[Picture | Still], None]


class _Easel:
    """What a picture of one size takes: a renderer, encoders, and the picture itself."""

    def __init__(self, renderer: Renderer, quality: Quality, frames_per_s: float) -> None:
        self._renderer, self._full, self._frames_per_s = renderer, quality, frames_per_s
        self._stand(quality)

    def resize(self, size: Fraction) -> None:
        """A share of the full width. The first picture of another size is a keyframe."""
        quality = self._full.sized(size)
        if quality != self._quality:
            self._renderer.resize(quality)
            self._stand(quality)

    def draw(self, state: State) -> None:
        self._renderer.draw(state.integration_state, state.tick, self.picture_rgb)

    @property
    def view_rgb(self) -> Image:
        """The picture without the strip."""
        return self.picture_rgb[: self._quality.view_height_px]

    def close(self) -> None:
        self._renderer.close()

    def _stand(self, quality: Quality) -> None:
        self._quality = quality
        self.picture_rgb = quality.blank_picture()
        self.encoders = {codec: Encoder(codec, self._frames_per_s, quality) for codec in Codec}


class View:
    """Draws `camera` of `model` from `start` to `stop`. The sink is called on its thread: it may only hand over."""

    def __init__(
        self, model: mujoco.MjModel, camera: str, frames_per_s: float, sink: Sink, quality: Quality = FAST
    ) -> None:
        self._model, self._camera, self._sink, self._quality = model, camera, sink, quality
        self._frames_per_s = frames_per_s
        self._handover = Handover()
        self._keyframe_s = dict.fromkeys(Codec, -KEYFRAME_EVERY_S)
        self._complaints = RateLimit(1)
        self._times_s: deque[float] = deque(maxlen=_RATE_WINDOW)
        self._thread = threading.Thread(target=self._run, name=f"view-{camera}", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        """Returns when the thread has ended."""
        self._handover.close()
        self._thread.join()

    def offer(self, state: State, received_ns: int) -> None:
        self._handover.offer(state, received_ns)

    def set_codecs(self, codecs: AbstractSet[Codec]) -> None:
        """What the peers need. H.264 is always made: the recorder keeps what the operator saw."""
        self._handover.set_codecs(codecs)

    def request_keyframe(self, codec: Codec) -> None:
        self._handover.request_keyframe(codec)

    def frames_per_s(self) -> float:
        """Of the last pictures; 0 where nothing was drawn for a second."""
        times_s = tuple(self._times_s)
        if len(times_s) < 2 or clock.monotonic_s() - times_s[-1] > 1.0:
            return 0.0
        return (len(times_s) - 1) / (times_s[-1] - times_s[0])

    def _run(self) -> None:
        cv2.setNumThreads(1)
        try:
            easel = _Easel(
                Renderer(self._model, self._camera, self._quality), self._quality, self._frames_per_s
            )
        except Exception:  # noqa: BLE001  # EGL and OpenGL fail with errors of their own
            _log.exception(
                "The view of %s cannot be drawn; `mart doctor` tells what is missing", self._camera
            )
            return
        try:
            self._draw_until_closed(easel)
        except Closed:
            _log.debug("The view of %s ends", self._camera)
        finally:
            easel.close()

    def _draw_until_closed(self, easel: _Easel) -> None:
        sizing, stills = Sizing(self._frames_per_s), Stills()
        drawn: Fresh | None = None
        rendered_ns = 0
        while True:
            fresh = self._handover.wait(_REPEAT_AFTER_S, _KEYFRAME_WITHIN_S)
            begun_s = clock.monotonic_s()
            if fresh is not None:
                easel.resize(sizing.size)
                try:
                    easel.draw(fresh.state)
                except InvalidInput as error:
                    if self._complaints.allows(begun_s):
                        _log.warning("A state was not drawn: %s", error)
                    continue
                drawn, rendered_ns = fresh, clock.wall_ns()
                self._times_s.append(clock.monotonic_s())
            if drawn is not None:
                self._encode(easel, drawn, rendered_ns)
            if fresh is not None:
                now_s = clock.monotonic_s()
                sizing.made(now_s - begun_s, now_s)
                still = stills.take(easel.view_rgb, fresh.state.stamps.stepped_ns, now_s)
                if still is not None:
                    self._sink(still)

    def _encode(self, easel: _Easel, drawn: Fresh, rendered_ns: int) -> None:
        now_s = clock.monotonic_s()
        watched, wanted = self._handover.take_orders()
        picture_i420 = to_i420(easel.picture_rgb)
        for codec in sorted(watched | {Codec.H264}):
            keyframe = codec in wanted or now_s - self._keyframe_s[codec] >= KEYFRAME_EVERY_S
            encoded = easel.encoders[codec].encode(picture_i420, int(now_s * CLOCK_HZ), keyframe)
            if encoded.keyframe:
                self._keyframe_s[codec] = now_s
            stamps = PictureStamps(drawn.received_ns, rendered_ns, clock.wall_ns())
            self._sink(Picture(encoded, drawn.state.tick, drawn.state.stamps.stepped_ns, stamps))
