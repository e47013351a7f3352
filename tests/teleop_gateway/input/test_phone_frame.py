"""The phone frame is what docs/protocol.md says, byte for byte, in every language."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.teleop_gateway.input.phone_frame import SIZE_BYTES, Flag, MalformedFrame, PhoneFrame
from tests.teleop_gateway.input.strategies import phone_frame

CASES = json.loads((Path(__file__).parents[1] / "golden" / "phone_frame.json").read_text())["cases"]

float32 = st.floats(width=32, allow_nan=False)
frames = st.builds(
    PhoneFrame,
    seat_epoch=st.integers(0, 2**32 - 1),
    sequence=st.integers(0, 2**32 - 1),
    seen_tick=st.integers(0, 2**32 - 1),
    sent_us=st.integers(0, 2**64 - 1),
    position=st.tuples(float32, float32, float32),
    quaternion_wxyz=st.tuples(float32, float32, float32, float32),
    gripper=float32,
    flags=st.integers(0, 31).map(Flag),
)


@pytest.mark.parametrize("case", CASES, ids=[case["name"] for case in CASES])
def test_golden_bytes(case: dict[str, Any]) -> None:
    said = case["frame"]
    frame = PhoneFrame(
        **{**said, "position": tuple(said["position"]), "quaternion_wxyz": tuple(said["quaternion_wxyz"])}
    )
    frame = PhoneFrame(**{**vars(frame), "flags": Flag(said["flags"])})
    assert frame.encode().hex() == case["hex"]
    assert PhoneFrame.decode(bytes.fromhex(case["hex"])).encode().hex() == case["hex"]


@given(frames)
def test_round_trip(frame: PhoneFrame) -> None:
    payload = frame.encode()
    assert len(payload) == SIZE_BYTES == 60
    assert PhoneFrame.decode(payload) == frame


@given(st.binary(max_size=200))
def test_anything_else_is_malformed(payload: bytes) -> None:
    if len(payload) != SIZE_BYTES or not payload.startswith(b"MPF1"):
        with pytest.raises(MalformedFrame):
            PhoneFrame.decode(payload)


def test_short_long_and_foreign_frames_are_named() -> None:
    good = phone_frame().encode()
    with pytest.raises(MalformedFrame, match="59 bytes"):
        PhoneFrame.decode(good[:-1])
    with pytest.raises(MalformedFrame, match="61 bytes"):
        PhoneFrame.decode(good + b"\0")
    with pytest.raises(MalformedFrame, match="MPF2"):
        PhoneFrame.decode(b"MPF2" + good[4:])


def test_flags_of_a_later_version_are_ignored() -> None:
    payload = bytearray(phone_frame(clutch=True).encode())
    struct.pack_into("<H", payload, 56, 0xFFE0 | Flag.CLUTCH)
    assert PhoneFrame.decode(bytes(payload)).flags == Flag.CLUTCH
