"""Encode a picture in every stream that somebody watches: each once, whatever the number of viewers.

A stream with a limit has pictures left out before they get too coarse. No encoder here can be told another rate, so a
stream with another limit begins anew, with a keyframe: soon where it is lower, seldom where it is higher.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from collections.abc import Set as AbstractSet

from mart.render import Image
from mart.teleop_gateway.video.encoder import (
    CLOCK_HZ,
    RECORDED,
    EncodedPicture,
    Encoder,
    Stream,
    to_i420,
)
from mart.teleop_gateway.video.quality import Quality

KEYFRAME_EVERY_S = 2.0
_PICTURE_BITS = 12_000  # of a moving scene, 640 x 496: coarser is worse than seldom
_LEAST_PICTURES_PER_S = 10.0
_LOWER, _LOWER_AFTER_S = 0.92, 0.5
_HIGHER, _HIGHER_AFTER_S = 1.1, 4.0


def picture_interval(limit_bps: float, frames_per_s: float) -> int:
    """Return every how manieth picture a stream with this limit shows."""
    if math.isinf(limit_bps):
        return 1
    wanted = math.ceil(frames_per_s * _PICTURE_BITS / limit_bps)
    return max(1, min(wanted, int(frames_per_s / _LEAST_PICTURES_PER_S)))


def may_follow(opened_bps: float, limit_bps: float, age_s: float) -> bool:
    """Tell whether a stream that was opened `age_s` ago with another limit is worth a new beginning."""
    if limit_bps < _LOWER * opened_bps:
        return age_s >= _LOWER_AFTER_S
    return limit_bps > _HIGHER * opened_bps and age_s >= _HIGHER_AFTER_S


class _OpenStream:
    def __init__(
        self, stream: Stream, frames_per_s: float, quality: Quality, limit_bps: float, now_s: float
    ) -> None:
        self.limit_bps, self.opened_s = limit_bps, now_s
        self.keyframe_s = -math.inf
        self._interval = picture_interval(limit_bps, frames_per_s)
        self._encoder = Encoder(stream, frames_per_s / self._interval, quality, limit_bps)
        self._count = -1

    def encode(self, picture_i420: Image, now_s: float, wanted: bool) -> EncodedPicture | None:
        """Return the picture, or None where this stream leaves it out."""
        self._count += 1
        if self._count % self._interval and not wanted:
            return None
        regular = math.isinf(self.limit_bps) and now_s - self.keyframe_s >= KEYFRAME_EVERY_S
        encoded = self._encoder.encode(picture_i420, int(now_s * CLOCK_HZ), wanted or regular)
        if encoded.keyframe:
            self.keyframe_s = now_s
        return encoded


class StreamEncoders:
    """Hold the encoders of pictures of one size."""

    def __init__(self, frames_per_s: float, quality: Quality) -> None:
        self._frames_per_s, self._quality = frames_per_s, quality
        self._open: dict[Stream, _OpenStream] = {}

    def encode(
        self,
        picture_rgb: Image,
        now_s: float,
        limits_bps: Mapping[Stream, float],
        wanted: AbstractSet[Stream],
    ) -> list[EncodedPicture]:
        """Return the picture, shape (height, width, 3), in each stream that shows it.

        `limits_bps`: who is watched, and with how many bits a second; infinity without a limit. The recorded stream is
        made in any case. `wanted`: streams whose next picture is to be a keyframe.
        """
        limits_bps = {RECORDED: math.inf, **limits_bps}
        self._open = {stream: opened for stream, opened in self._open.items() if stream in limits_bps}
        picture_i420 = to_i420(picture_rgb)
        pictures = []
        for stream in sorted(limits_bps):
            opened = self._opened(stream, limits_bps[stream], now_s)
            encoded = opened.encode(picture_i420, now_s, stream in wanted)
            if encoded is not None:
                pictures.append(encoded)
        return pictures

    def _opened(self, stream: Stream, limit_bps: float, now_s: float) -> _OpenStream:
        opened = self._open.get(stream)
        if opened is None or may_follow(opened.limit_bps, limit_bps, now_s - opened.opened_s):
            opened = _OpenStream(stream, self._frames_per_s, self._quality, limit_bps, now_s)
            self._open[stream] = opened
        return opened
