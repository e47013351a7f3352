"""What peers say, whatever it is, is heard or left out."""

from __future__ import annotations

import json
from typing import Any, cast
from unittest import mock

from hypothesis import example, given
from hypothesis import strategies as st

from mart.protocol.tokens import Role
from mart.teleop_gateway.input.driving import Driving, InputDevice
from mart.teleop_gateway.input.retarget import Retarget
from mart.teleop_gateway.input.seat_input import SeatInput
from mart.teleop_gateway.input.tool_motion import ToolMotion
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.video.motion_to_photon import MotionToPhoton
from mart.teleop_gateway.webrtc.peer import Peer
from mart.teleop_gateway.webrtc.peer_messages import PeerMessages
from mart.teleop_gateway.webrtc.speech_rights import SpeechRights
from tests.support.fuzzing import fuzzing
from tests.teleop_gateway.input.strategies import phone_frame
from tests.teleop_gateway.input.test_driving import HOME

NUMBERS = st.one_of(
    st.integers(),
    st.floats(),
    st.sampled_from([2**53, 2**63 - 1, 2**63, -(2**63), 10**400, 1e306, 1.7e308, True, None, "7"]),
)
MESSAGES = st.fixed_dictionaries(
    {"type": st.sampled_from(["ping", "clock", "seen", "drawing", "input", "cue", "token", "other"])},
    optional={
        "t_us": NUMBERS,
        "offset_ns": NUMBERS,
        "tick": NUMBERS,
        "on": st.sampled_from([True, False, 1, None]),
        "p50_ms": NUMBERS,
        "p95_ms": NUMBERS,
        "per_s": NUMBERS,
        "input": st.sampled_from(["phone", "keyboard", "", 7]),
        "cue": st.sampled_from(["wait", "go", "", 7]),
        "token": st.sampled_from(["", "a.b.c", 7]) | st.text(),
    },
)


def driven(nobody: mock.MagicMock) -> tuple[SeatInput, Driving]:
    """The input of a seat that a keyboard drives, without a room behind it."""
    seat_input = SeatInput(
        nobody, SeatAddress("room-1", "arm0"), hand_scale=1.0, on_command=nobody, on_new_holder=nobody
    )
    driving = seat_input.driving = Driving("arm0", 7, 1, Retarget(0.0))
    driving.connect(InputDevice.KEYBOARD)
    return seat_input, driving


@fuzzing(examples=200)
@given(said=st.lists(MESSAGES, max_size=6), now_ns=st.integers(0, 2**62))
@example(said=[{"type": "clock", "offset_ns": 1}, {"type": "seen", "tick": 1, "t_us": 1e306}], now_ns=1)
@example(said=[{"type": "clock", "offset_ns": -(2**63)}], now_ns=2**62)
@example(said=[{"type": "clock", "offset_ns": -16_667_001}], now_ns=0)
def test_no_message_is_more_than_a_seat_can_take(said: list[dict[str, Any]], now_ns: int) -> None:
    nobody = mock.MagicMock()
    seat_input, driving = driven(nobody)
    messages = PeerMessages(
        peers=nobody,
        pages=nobody,
        seat_input=seat_input,
        views=nobody,
        cameras=nobody,
        latency=MotionToPhoton("arm0"),
        events=nobody,
        broadcaster=nobody,
        voice=nobody,
        speech=SpeechRights(SeatAddress("room-1", "arm0"), b"s" * 32),
    )
    peer = cast("Peer", mock.MagicMock(role=Role.BROWSER, clock_offset_ns=None, limit_bps=3e5))
    for message in said:
        messages.on_status(peer, json.dumps(message))
    command = driving.receive(InputDevice.KEYBOARD, phone_frame(1).encode(), ToolMotion(HOME), 1.0, now_ns)
    if command is not None:
        command.SerializeToString()
