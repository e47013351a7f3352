"""Encoded pictures decode at once, from any keyframe on, and still say their tick."""

from __future__ import annotations

import av
import numpy as np
import pytest
from av.video.codeccontext import VideoCodecContext
from av.video.frame import PictureType

from mart.render import Image
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.video.encoder import (
    CLOCK_HZ,
    RECORDED,
    Codec,
    EncodedPicture,
    Encoder,
    Stream,
    to_i420,
)
from mart.teleop_gateway.video.h264_level import h264_level
from mart.teleop_gateway.video.quality import FAST, FULL, Quality

DECODERS = {Codec.H264: "h264", Codec.VP8: "vp8"}
FRAMES_PER_S = 20.0
SPS, PPS, IDR = 7, 8, 5

both = pytest.mark.parametrize("codec", list(Codec))


Y, X = np.mgrid[0 : tick_code.HEIGHT_PX, 0 : tick_code.WIDTH_PX]
SCENE = np.stack([X * 0.3, Y * 0.4, 128 + 40 * np.sin(X / 30)], axis=2).astype(np.uint8)


def picture(tick: int) -> Image:
    """A scene in which everything moves, and its tick."""
    rgb = np.roll(SCENE, 3 * tick, axis=1)
    rgb[200:280, 4 * tick % 560 : 4 * tick % 560 + 80] = (213, 94, 0)
    tick_code.write(tick, rgb[tick_code.VIEW_HEIGHT_PX :])
    return rgb


def encode(codec: Codec, ticks: range, keyframes: frozenset[int] = frozenset()) -> list[EncodedPicture]:
    encoder = Encoder(Stream(codec), FRAMES_PER_S)
    step = int(CLOCK_HZ / FRAMES_PER_S)
    return [encoder.encode(to_i420(picture(t)), t * step, keyframe=t in keyframes) for t in ticks]


def decoder(codec: Codec) -> VideoCodecContext:
    context = av.CodecContext.create(DECODERS[codec], "r")
    assert isinstance(context, VideoCodecContext)
    context.thread_type = "NONE"
    return context


def nal_types(data: bytes) -> list[int]:
    starts = [i + 3 for i in range(len(data) - 3) if data[i : i + 3] == b"\0\0\1"]
    return [data[start] & 0x1F for start in starts]


@both
def test_every_picture_comes_out_at_once_and_says_its_tick(codec: Codec) -> None:
    reader = decoder(codec)
    for tick, encoded in enumerate(encode(codec, range(100, 140)), start=100):
        (frame,) = reader.decode(av.Packet(encoded.data))
        luma = np.asarray(frame.to_ndarray(format="gray"), np.uint8)
        assert tick_code.read(luma) == tick
        assert encoded.pts == tick * CLOCK_HZ / FRAMES_PER_S


@both
def test_it_looks_like_what_was_drawn(codec: Codec) -> None:
    reader = decoder(codec)
    frames = [reader.decode(av.Packet(encoded.data))[0] for encoded in encode(codec, range(30))]
    error = frames[-1].to_ndarray(format="rgb24").astype(float) - picture(29)
    psnr_db = 10 * np.log10(255**2 / np.mean(error[: tick_code.VIEW_HEIGHT_PX] ** 2))
    assert psnr_db > 30


@both
def test_keyframes_come_first_and_when_asked_and_never_else(codec: Codec) -> None:
    encoded = encode(codec, range(60), keyframes=frozenset({17, 18, 40}))
    assert [i for i, picture in enumerate(encoded) if picture.keyframe] == [0, 17, 18, 40]


@both
def test_a_late_joiner_starts_at_any_keyframe(codec: Codec) -> None:
    encoded = encode(codec, range(30), keyframes=frozenset({20}))
    reader = decoder(codec)
    for tick, late in enumerate(encoded[20:], start=20):
        (frame,) = reader.decode(av.Packet(late.data))
        assert tick_code.read(np.asarray(frame.to_ndarray(format="gray"), np.uint8)) == tick


def test_each_idr_carries_its_parameter_sets() -> None:
    for encoded in encode(Codec.H264, range(30), keyframes=frozenset({10, 20})):
        types = nal_types(encoded.data)
        assert (IDR in types) == encoded.keyframe
        assert (SPS in types) == (PPS in types) == encoded.keyframe


def test_h264_is_constrained_baseline_without_reordering() -> None:
    reader = decoder(Codec.H264)
    types = {
        frame.pict_type
        for encoded in encode(Codec.H264, range(60))
        for frame in reader.decode(av.Packet(encoded.data))
    }
    assert types <= {PictureType.I, PictureType.P}
    assert reader.has_b_frames == 0
    assert reader.profile == "Constrained Baseline"


@both
def test_the_rate_stays_what_a_wireless_network_carries(codec: Codec) -> None:
    encoded = encode(codec, range(100))
    bits_per_s = 8 * sum(len(picture.data) for picture in encoded) / (100 / FRAMES_PER_S)
    assert bits_per_s < 3_000_000  # everything moves: far more than a room ever does


@both
def test_a_larger_picture_says_its_tick_too(codec: Codec) -> None:
    rgb = FULL.blank_picture()
    tick_code.write(4711, rgb[FULL.view_height_px :])
    encoded = Encoder(Stream(codec), FRAMES_PER_S, FULL).encode(to_i420(rgb), 0, keyframe=True)
    (frame,) = decoder(codec).decode(av.Packet(encoded.data))
    assert tick_code.read(np.asarray(frame.to_ndarray(format="gray"), np.uint8)) == 4711


@pytest.mark.parametrize(
    ("quality", "frames_per_s", "level"),
    [(FAST, 20.0, 31), (FAST, 60.0, 31), (FULL, 20.0, 31), (FULL, 60.0, 32), (FULL, 100.0, 42)],
)
def test_the_stream_says_the_level_that_its_size_and_rate_need(
    quality: Quality, frames_per_s: float, level: int
) -> None:
    """At 60 pictures of 960 x 744 a second there are 169,200 macroblocks; level 3.1 allows 108,000."""
    encoder = Encoder(RECORDED, frames_per_s, quality)
    data = encoder.encode(to_i420(quality.blank_picture()), 0, keyframe=True).data
    sps = data.index(b"\0\0\1\x67") + 4
    assert data[sps + 2] == level


def test_what_no_level_allows_gets_the_largest() -> None:
    assert h264_level(8192, 4096, 1000.0) == 52
