"""Pictures to H.264, and to VP8 for a browser without it: one encoder each, whatever the number of viewers.

The settings trade size for time: a picture must leave in 2 ms and be decoded without waiting for another one.
"""

from __future__ import annotations

import enum
import fractions
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import av
import cv2
from av.video.codeccontext import VideoCodecContext
from av.video.frame import PictureType

from mart.teleop_gateway.tick_code import HEIGHT_PX, WIDTH_PX, Image

CLOCK_HZ = 90_000  # RTP's video clock
BITRATE_BPS = 2_500_000

_VBV_KBPS = BITRATE_BPS // 1000
_VBV_KBIT = 500  # 0.2 s: an IDR may be large, but not for long


class Codec(enum.StrEnum):
    H264 = "H264"
    VP8 = "VP8"


@dataclass(frozen=True)
class Encoded:
    """One picture. pts: in 1/90000 s of the monotonic clock. `data`: an H.264 access unit (Annex B) or a VP8 frame."""

    codec: Codec
    data: bytes
    pts: int
    keyframe: bool


def to_i420(picture_rgb: Image) -> Image:
    """Shape (496, 640, 3) → (744, 640). OpenCV takes 0.3 ms where a new sws context takes 3."""
    return cv2.cvtColor(picture_rgb, cv2.COLOR_RGB2YUV_I420)  # type: ignore[return-value]


class Encoder(ABC):
    codec: Codec

    def __init__(self, frames_per_s: float) -> None:
        context = av.CodecContext.create(self._name, "w")
        assert isinstance(context, VideoCodecContext)
        context.width, context.height, context.pix_fmt = WIDTH_PX, HEIGHT_PX, "yuv420p"
        context.bit_rate = BITRATE_BPS
        context.time_base = fractions.Fraction(1, CLOCK_HZ)
        context.framerate = fractions.Fraction(frames_per_s).limit_denominator(1000)
        context.options = dict(self._options)
        context.thread_count = 1
        context.profile = self._profile
        self._context = context

    @property
    @abstractmethod
    def _name(self) -> str: ...

    @property
    @abstractmethod
    def _options(self) -> Mapping[str, str]: ...

    @property
    def _profile(self) -> str | None:
        return None

    def encode(self, picture_i420: Image, pts: int, keyframe: bool) -> Encoded:
        frame = av.VideoFrame.from_ndarray(picture_i420, format="yuv420p")
        frame.pts = pts
        frame.time_base = self._context.time_base
        frame.pict_type = PictureType.I if keyframe else PictureType.NONE
        packets = self._context.encode(frame)
        return Encoded(self.codec, b"".join(map(bytes, packets)), pts, any(p.is_keyframe for p in packets))


class H264Encoder(Encoder):
    """Constrained baseline, no reordering, SPS and PPS on every IDR; an I picture that is asked for is an IDR."""

    codec = Codec.H264
    _name = "libx264"
    _options = {  # noqa: RUF012  # read only, copied on use
        "preset": "ultrafast",
        "tune": "zerolatency",
        "level": "31",
        "x264-params": (
            f"repeat-headers=1:keyint=3000:scenecut=0:bframes=0:threads=1:vbv-maxrate={_VBV_KBPS}:vbv-bufsize={_VBV_KBIT}"
        ),
    }

    _profile = "Baseline"


class Vp8Encoder(Encoder):
    """libvpx at its fastest, without the camera denoiser that rendered pictures have no use for."""

    codec = Codec.VP8
    _name = "libvpx"
    _options = {  # noqa: RUF012  # read only, copied on use
        "deadline": "realtime",
        "cpu-used": "-10",
        "noise-sensitivity": "0",
        "lag-in-frames": "0",
        "auto-alt-ref": "0",
        "g": "3000",
        "error-resilient": "default",
    }


ENCODERS: Mapping[Codec, Callable[[float], Encoder]] = {Codec.H264: H264Encoder, Codec.VP8: Vp8Encoder}
