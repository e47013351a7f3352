"""A picture in every stream that is watched: one recorded in full, and others within what their links carry."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.render import Image
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.video.encoder import RECORDED, Audience, Codec, EncodedPicture, Stream
from mart.teleop_gateway.video.quality import FAST
from mart.teleop_gateway.video.stream_encoders import StreamEncoders, may_follow, picture_interval

FRAMES_PER_S = 20.0
HOLDERS = Stream(Codec.H264, Audience.HOLDER)
both = pytest.mark.parametrize("codec", list(Codec))

Y, X = np.mgrid[0 : tick_code.HEIGHT_PX, 0 : tick_code.WIDTH_PX]
SCENE = np.stack([X * 0.3, Y * 0.4, 128 + 40 * np.sin(X / 30)], axis=2).astype(np.uint8)


def moving(number: int) -> Image:
    """A scene of which a fifth moves."""
    rgb = SCENE.copy()
    rgb[150:300] = np.roll(SCENE[150:300], 5 * number, axis=1)
    return rgb


def encode(limits_bps: dict[Stream, float], seconds: float, begin_s: float = 0.0) -> list[EncodedPicture]:
    encoders = StreamEncoders(FRAMES_PER_S, FAST)
    count = int(seconds * FRAMES_PER_S)
    made = [encoders.encode(moving(n), begin_s + n / FRAMES_PER_S, limits_bps, set()) for n in range(count)]
    return list(itertools.chain(*made))


def bps_of(pictures: list[EncodedPicture], stream: Stream, seconds: float) -> float:
    return 8 * sum(len(picture.data) for picture in pictures if picture.stream == stream) / seconds


def test_the_recorded_stream_is_made_whoever_watches() -> None:
    assert {picture.stream for picture in encode({}, 0.5)} == {RECORDED}


@both
@pytest.mark.parametrize("limit_bps", [150_000.0, 400_000.0])
def test_a_limited_stream_stays_below_its_limit_and_leaves_the_recorded_one_alone(
    codec: Codec, limit_bps: float
) -> None:
    stream = Stream(codec, Audience.HOLDER)
    alone, beside = encode({}, 4), encode({stream: limit_bps}, 4)
    assert bps_of(beside, stream, 4) < 1.25 * limit_bps
    assert [picture for picture in beside if picture.stream == RECORDED] == alone


def test_no_picture_of_a_limited_stream_holds_the_link_up() -> None:
    """A keyframe of 30 kB takes half a second at 500 kbit/s."""
    pictures = [picture for picture in encode({HOLDERS: 500_000.0}, 4) if picture.stream == HOLDERS]
    assert pictures[0].keyframe
    assert max(8 * len(picture.data) / 500_000 for picture in pictures) < 0.25


def test_a_wish_for_a_keyframe_is_met_at_once_also_by_a_stream_that_leaves_pictures_out() -> None:
    encoders = StreamEncoders(FRAMES_PER_S, FAST)
    limits_bps = {HOLDERS: 150_000.0}
    shown = [len(encoders.encode(moving(n), n * 0.05, limits_bps, set())) for n in range(4)]
    assert shown == [2, 1, 2, 1]
    made = {picture.stream: picture for picture in encoders.encode(moving(5), 0.25, limits_bps, {HOLDERS})}
    assert made[HOLDERS].keyframe
    assert not made[RECORDED].keyframe


def test_a_stream_with_another_limit_begins_anew_with_a_keyframe() -> None:
    encoders = StreamEncoders(FRAMES_PER_S, FAST)
    keyframes = []
    for n in range(60):
        limits_bps = {HOLDERS: 800_000.0 if n < 20 else 300_000.0}
        pictures = encoders.encode(moving(n), n / FRAMES_PER_S, limits_bps, set())
        keyframes += [n for picture in pictures if picture.stream == HOLDERS and picture.keyframe]
    assert keyframes == [0, 20]


def test_a_stream_that_nobody_watches_ends() -> None:
    encoders = StreamEncoders(FRAMES_PER_S, FAST)
    encoders.encode(moving(0), 0.0, {HOLDERS: 500_000.0}, set())
    assert {picture.stream for picture in encoders.encode(moving(1), 0.05, {}, set())} == {RECORDED}
    (again,) = (
        picture
        for picture in encoders.encode(moving(2), 0.1, {HOLDERS: 500_000.0}, set())
        if picture.stream == HOLDERS
    )
    assert again.keyframe


@given(limit_bps=st.floats(150_000, 1e8) | st.just(math.inf), frames_per_s=st.floats(5, 250))
def test_pictures_are_left_out_down_to_ten_a_second(limit_bps: float, frames_per_s: float) -> None:
    interval = picture_interval(limit_bps, frames_per_s)
    assert interval >= 1
    assert frames_per_s / interval >= min(frames_per_s, 10.0)


@pytest.mark.parametrize(
    ("limit_bps", "frames_per_s", "interval"),
    [(math.inf, 60.0, 1), (720_000, 60.0, 1), (450_000, 60.0, 2), (250_000, 20.0, 1), (150_000, 20.0, 2)],
)
def test_a_picture_gets_its_bits(limit_bps: float, frames_per_s: float, interval: int) -> None:
    assert picture_interval(limit_bps, frames_per_s) == interval


@pytest.mark.parametrize(
    ("limit_bps", "age_s", "follows"),
    [
        (900_000, 1.0, True),
        (900_000, 0.1, False),
        (980_000, 60.0, False),
        (1_050_000, 60.0, False),
        (1_300_000, 1.0, False),
        (1_300_000, 5.0, True),
    ],
)
def test_a_lower_limit_is_followed_soon_and_a_higher_one_seldom(
    limit_bps: float, age_s: float, follows: bool
) -> None:
    assert may_follow(1_000_000, limit_bps, age_s) is follows
