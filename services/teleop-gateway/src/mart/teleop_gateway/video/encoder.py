"""Encode pictures in H.264, and in VP8 for a browser without it.

The settings trade size for time: a picture must leave in 2 ms and be decoded without waiting for another one.
"""

from __future__ import annotations

import enum
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from types import MappingProxyType

import av
import cv2
from av.video.codeccontext import VideoCodecContext
from av.video.frame import PictureType

from mart.render import Image
from mart.teleop_gateway.video.h264_level import h264_level
from mart.teleop_gateway.video.quality import FAST, Quality

CLOCK_HZ = 90_000  # RTP's video clock
_TIME_BASE = Fraction(1, CLOCK_HZ)


class Codec(enum.StrEnum):
    """Name a video codec as WebRTC does."""

    H264 = "H264"
    VP8 = "VP8"


class Audience(enum.StrEnum):
    """Name who a stream of pictures is for. Whoever's link carries less gets one of their own, and spoils no other."""

    EVERYONE = "everyone"
    HOLDER = "holder"
    VIEWERS = "viewers"


@dataclass(frozen=True, order=True)
class Stream:
    """Name one stream of a seat's pictures."""

    codec: Codec
    audience: Audience = Audience.EVERYONE


RECORDED = Stream(Codec.H264)  # is always made: the recorder keeps it


@dataclass(frozen=True)
class EncodedPicture:
    """Hold one encoded picture: an H.264 access unit (Annex B) or a VP8 frame. `pts` is in 1/90000 s, monotonic."""

    codec: Codec
    data: bytes
    pts: int
    keyframe: bool
    audience: Audience = Audience.EVERYONE

    @property
    def stream(self) -> Stream:
        """Return the stream that it belongs to."""
        return Stream(self.codec, self.audience)


@dataclass(frozen=True)
class _Recipe:
    """Say how FFmpeg is told to encode. bitrate_bps: 0 where the quality is constant instead."""

    encoder: str
    profile: str | None
    bitrate_bps: int
    options: Mapping[str, str]


_X264 = {
    "repeat-headers": 1,  # SPS and PPS on every IDR: late joiners and players of the recording start at any
    "keyint": 3000,  # IDRs come when asked for
    "scenecut": 0,
    "bframes": 0,
    "threads": 1,
}
_FINEST_QP = 20
_CONSTANT_QUALITY = {
    # A constant quantiser: any rate control looks at every picture twice (1.17 ms against 0.87) and saves nothing where
    # the camera stands still. A moving two-arm scene takes 0.6 Mbit/s, an IDR 27 kB; CRF 22 looks the same for 0.8.
    "qp": _FINEST_QP,
}
_BUFFER_S = 0.25  # of a limited stream: what a keyframe may take at once


def _x264_params(options: Mapping[str, int]) -> str:
    return ":".join(f"{name}={value}" for name, value in options.items())


_RECIPES = MappingProxyType(
    {
        # Constrained baseline without reordering; an I picture that is asked for is an IDR.
        Codec.H264: _Recipe(
            encoder="libx264",
            profile="Baseline",
            bitrate_bps=0,
            options={
                "preset": "ultrafast",
                "tune": "zerolatency",
                "x264-params": _x264_params(_X264 | _CONSTANT_QUALITY),
            },
        ),
        # libvpx at its fastest, without the camera denoiser that rendered pictures have no use for.
        Codec.VP8: _Recipe(
            encoder="libvpx",
            profile=None,
            bitrate_bps=1_500_000,
            options={
                "deadline": "realtime",
                "cpu-used": "-10",
                "noise-sensitivity": "0",
                "lag-in-frames": "0",
                "auto-alt-ref": "0",
                "g": "3000",
            },
        ),
    }
)


def _recipe(codec: Codec, limit_bps: float) -> _Recipe:
    """Return how to encode with so many bits a second at most, and with less where the finest picture takes less."""
    recipe = _RECIPES[codec]
    if limit_bps >= (recipe.bitrate_bps or math.inf):
        return recipe
    limit = str(int(limit_bps))
    limits = {"maxrate": limit, "bufsize": str(int(_BUFFER_S * limit_bps))}
    if codec is Codec.H264:
        limits |= {"x264-params": _x264_params(_X264), "qmin": str(_FINEST_QP)}
    else:
        limits |= {"minrate": limit}  # libvpx knows a constant rate by both
    return replace(recipe, bitrate_bps=int(limit_bps), options={**recipe.options, **limits})


class Encoder:
    """Encode one stream of pictures in one codec: in constant quality, or at most `limit_bps` bits a second."""

    def __init__(
        self, stream: Stream, frames_per_s: float, quality: Quality = FAST, limit_bps: float = math.inf
    ) -> None:
        recipe = _recipe(stream.codec, limit_bps)
        context = av.CodecContext.create(recipe.encoder, "w")
        assert isinstance(context, VideoCodecContext)
        context.width, context.height, context.pix_fmt = quality.width_px, quality.height_px, "yuv420p"
        context.time_base = _TIME_BASE
        context.framerate = Fraction(frames_per_s).limit_denominator(1000)
        context.bit_rate = recipe.bitrate_bps
        context.profile = recipe.profile
        context.options = dict(recipe.options)
        if stream.codec is Codec.H264:
            level = h264_level(quality.width_px, quality.height_px, frames_per_s)
            context.options = {**recipe.options, "level": str(level)}
        context.thread_count = 1
        self._stream = stream
        self._context = context

    def encode(self, picture_i420: Image, pts: int, keyframe: bool) -> EncodedPicture:
        """Return the picture, shape (3/2 height, width) in I420, encoded; a keyframe where one is asked for."""
        frame = av.VideoFrame.from_numpy_buffer(picture_i420, format="yuv420p")  # both encoders copy it
        frame.pts = pts
        frame.time_base = _TIME_BASE
        frame.pict_type = PictureType.I if keyframe else PictureType.NONE
        packets = self._context.encode(frame)
        keyframe = any(packet.is_keyframe for packet in packets)
        data = b"".join(map(bytes, packets))
        return EncodedPicture(self._stream.codec, data, pts, keyframe, self._stream.audience)


def to_i420(picture_rgb: Image) -> Image:
    """Return an RGB picture, shape (height, width, 3), as I420, shape (3/2 height, width)."""
    # OpenCV takes 0.15 ms where a new context of FFmpeg's swscale takes 3.
    return cv2.cvtColor(picture_rgb, cv2.COLOR_RGB2YUV_I420)  # type: ignore[return-value]
