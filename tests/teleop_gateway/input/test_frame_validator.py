"""Bad frames never reach an arm; a hand in doubt never holds one."""

from __future__ import annotations

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.teleop_gateway.input import frame_validator
from mart.teleop_gateway.input.frame_validator import FrameRejection, FrameValidator, HandSample
from mart.teleop_gateway.input.phone_frame import Flag, PhoneFrame
from tests.teleop_gateway.input.strategies import phone_frame

EPOCH = 7
FRAME_S = 1 / 60


class Stream:
    """Sends frames to a validator, one every 1/60 s unless told."""

    def __init__(self) -> None:
        self.validator = FrameValidator(EPOCH)
        self.now_s = 100.0
        self.sequence = 0

    def send(self, after_s: float = FRAME_S, **given: object) -> HandSample | None:
        self.now_s += after_s
        self.sequence += 1
        frame = phone_frame(self.sequence, sent_us=int(self.now_s * 1e6), **given)  # type: ignore[arg-type]
        return self.validator.validate(frame.encode(), self.now_s)

    def clutch(self, after_s: float = FRAME_S, **given: object) -> bool:
        hand = self.send(after_s, clutch=True, **given)
        assert hand is not None
        return hand.clutch

    def press(self) -> None:
        self.send()
        self.send()
        assert self.clutch()


@pytest.fixture
def stream() -> Stream:
    return Stream()


HALF_NORM = (0.5, 0.0, 0.0, 0.0)
NAN, INFINITY = math.nan, math.inf


@pytest.mark.parametrize(
    ("frame", "reason"),
    [
        (phone_frame(epoch=8), FrameRejection.EPOCH),
        (phone_frame(position=(NAN, 0, 0)), FrameRejection.NOT_FINITE),
        (phone_frame(position=(0, INFINITY, 0)), FrameRejection.NOT_FINITE),
        (phone_frame(quaternion_wxyz=(NAN, 0, 0, 0)), FrameRejection.NOT_FINITE),
        (phone_frame(gripper=NAN), FrameRejection.NOT_FINITE),
        (phone_frame(quaternion_wxyz=HALF_NORM), FrameRejection.NORM),
        (phone_frame(quaternion_wxyz=(0, 0, 0, 0)), FrameRejection.NORM),
        (phone_frame(quaternion_wxyz=(1e30, 0, 0, 0)), FrameRejection.NORM),
        (phone_frame(gripper=-0.1), FrameRejection.GRIPPER),
        (phone_frame(gripper=1.1), FrameRejection.GRIPPER),
        (phone_frame(position=(80, 80, 0)), FrameRejection.POSITION),
    ],
    ids=lambda value: value.value if isinstance(value, FrameRejection) else "",
)
def test_a_bad_frame_is_dropped_and_counted(frame: PhoneFrame, reason: FrameRejection) -> None:
    watch = FrameValidator(EPOCH)
    assert watch.validate(frame.encode(), 100.0) is None
    assert watch.rejected == {reason: 1}


@pytest.mark.parametrize("payload", [b"", b"x" * 59, b"x" * 60, b"x" * 61, b"MPF1" * 16])
def test_garbage_is_dropped_and_counted(payload: bytes) -> None:
    watch = FrameValidator(EPOCH)
    assert watch.validate(payload, 100.0) is None
    assert watch.rejected == {FrameRejection.MALFORMED: 1}


def test_a_replayed_or_overtaken_frame_is_dropped(stream: Stream) -> None:
    first, second = phone_frame(1).encode(), phone_frame(2).encode()
    assert stream.validator.validate(second, 100.0)
    assert stream.validator.validate(second, 100.01) is None
    assert stream.validator.validate(first, 100.02) is None
    assert stream.validator.rejected == {FrameRejection.SEQUENCE: 2}


def test_ten_kilohertz_is_cut_to_the_allowed_rate(stream: Stream) -> None:
    admitted = sum(stream.send(after_s=1e-4) is not None for _ in range(20_000))
    assert admitted == pytest.approx(2 * frame_validator.MAX_FRAMES_PER_S, abs=1)
    assert stream.validator.rejected == {FrameRejection.RATE: 20_000 - admitted}


@given(st.binary(min_size=60, max_size=60), st.integers(0, 3))
def test_whatever_is_admitted_is_sound(noise: bytes, flips: int) -> None:
    payload = bytearray(phone_frame().encode())
    for index in range(flips):
        at, value = noise[2 * index] % 60, noise[2 * index + 1]
        struct.pack_into("B", payload, at, value)
    hand = FrameValidator(EPOCH).validate(bytes(payload), 100.0)
    if hand is not None:
        assert hand.frame.seat_epoch == EPOCH
        assert all(map(math.isfinite, hand.pose_phone_in_session.position))
        assert 0.0 <= hand.frame.gripper <= 1.0


def test_a_clutch_held_since_before_does_not_count(stream: Stream) -> None:
    assert not any(stream.clutch() for _ in range(5))
    stream.send()
    assert stream.clutch()


@pytest.mark.parametrize(
    "doubt",
    [
        {"after_s": 0.21},
        {"tracking": False},
        {"position": (0.16, 0.0, 0.0)},
        {"quaternion_wxyz": (math.cos(0.31), math.sin(0.31), 0.0, 0.0)},
    ],
    ids=["gap", "tracking lost", "jump", "turn"],
)
def test_doubt_releases_the_clutch_until_it_is_pressed_anew(stream: Stream, doubt: dict[str, object]) -> None:
    stream.press()
    assert not stream.clutch(**doubt)  # type: ignore[arg-type]
    after = {key: value for key, value in doubt.items() if key in {"position", "quaternion_wxyz"}}
    assert not stream.clutch(**after)  # type: ignore[arg-type]
    stream.send(**after)  # type: ignore[arg-type]
    assert stream.clutch(**after)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "motion",
    [
        {"after_s": 0.19},
        {"position": (0.14, 0.0, 0.0)},
        {"position": (0.16, 0.0, 0.0), "after_s": 0.11},
        {"quaternion_wxyz": (math.cos(0.29), math.sin(0.29), 0.0, 0.0)},
    ],
    ids=["pause", "quick", "far in more time", "turn"],
)
def test_a_hand_may_do_what_hands_do(stream: Stream, motion: dict[str, object]) -> None:
    stream.press()
    assert stream.clutch(**motion)  # type: ignore[arg-type]


def test_rejected_frames_do_not_feed_the_hand(stream: Stream) -> None:
    """A stream of bad frames is silence: after it the clutch is open."""
    stream.press()
    for _ in range(20):
        assert stream.send(clutch=True, gripper=2.0) is None
    assert not stream.clutch()


@given(st.lists(st.tuples(st.booleans(), st.booleans(), st.sampled_from((0.016, 0.19, 0.21))), max_size=20))
def test_the_clutch_counts_only_while_pressed_and_tracked(steps: list[tuple[bool, bool, float]]) -> None:
    stream = Stream()
    let_go_since_doubt = False
    for pressed, tracking, after_s in steps:
        hand = stream.send(after_s, clutch=pressed, tracking=tracking)
        assert hand is not None
        doubt = not tracking or (pressed and (after_s > frame_validator.GAP_S or stream.sequence == 1))
        let_go_since_doubt = not doubt and (let_go_since_doubt or not pressed)
        assert hand.clutch == (pressed and let_go_since_doubt)
        assert (Flag.CLUTCH in hand.frame.flags) == pressed


@given(
    st.lists(st.tuples(st.booleans(), st.floats(0.0, 4.0)), max_size=80),
    st.floats(-1e4, 1e4),
    st.floats(0.0, 0.4),
)
def test_no_frame_that_waited_ever_holds_an_arm(
    frames: list[tuple[bool, float]], offset_s: float, transit_s: float
) -> None:
    """Whatever is held back, for however long, and however the two clocks differ."""
    validator, sent_s, arrived_s = FrameValidator(EPOCH), 1e5, 0.0
    for number, (held, late_s) in enumerate([(False, 0.0)] * 90 + frames):
        sent_s += FRAME_S
        arrived_s = max(arrived_s, sent_s + transit_s + late_s)  # in order, as a queue delivers them
        frame = phone_frame(number, sent_us=int((sent_s + offset_s) * 1e6), clutch=held)
        hand = validator.validate(frame.encode(), arrived_s)
        if hand is not None and arrived_s - sent_s - transit_s > frame_validator.MAX_WAIT_S + 0.01:
            # What comes late for two seconds is taken for another clock: the queue of a link is never that long,
            # because nothing is queued behind 300 bytes.
            assert not hand.clutch or arrived_s - (1e5 + 91 * FRAME_S + transit_s) > 2.0
