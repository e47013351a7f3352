"""The status channel says what docs/protocol.md says, fits one packet, and shrugs at nonsense."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput
from mart.protocol.messages import (
    BARRIER_PHASE_STALLED,
    CUE_WAIT,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HOLD,
    OPERATOR_SCRIPT,
    ArmState,
    Episode,
    RoomStatus,
    Seat,
    State,
    Waiting,
)
from mart.protocol.tasks import MAX_ARMS
from mart.teleop_gateway.input.driving import Driving, InputDevice
from mart.teleop_gateway.input.frame_validator import FrameRejection
from mart.teleop_gateway.input.retarget import Retarget
from mart.teleop_gateway.input.tool_motion import ToolMotion
from mart.teleop_gateway.video.motion_to_photon import STAGES, LatencySummary
from mart.teleop_gateway.video.tool_projection import ToolView
from mart.teleop_gateway.voice.lanes import LANES, Speaker
from mart.teleop_gateway.webrtc import status_channel
from mart.teleop_gateway.webrtc.said_cues import SaidCue
from tests.teleop_gateway.input.strategies import phone_frame
from tests.teleop_gateway.input.test_driving import HOME

LATENCY = LatencySummary(
    p50_ms=45.04, p95_ms=70.5, frames=300, stages=tuple(float(i) for i in range(len(STAGES)))
)


def driving() -> Driving:
    driving = Driving("arm0", 7, 100, Retarget(0.0))
    driving.connect(InputDevice.PHONE)
    driving.receive(InputDevice.PHONE, phone_frame(41, gripper=0.25).encode(), ToolMotion(HOME), 10.0, 0)
    return driving


def test_a_tick_message_tells_everything_a_page_shows() -> None:
    state = State(
        tick=182, real_time_factor=0.9987, arms=[ArmState(arm="arm1"), ArmState(arm="arm0", sequence=100)]
    )
    room = RoomStatus(
        barrier=BARRIER_PHASE_STALLED,
        waiting_for=[Waiting(arm="arm1", since_s=0.801)],
        seats=[Seat(arm="arm1", operator=OPERATOR_HOLD), Seat(arm="arm0", ready=True)],
        episode=Episode(phase=EPISODE_PHASE_RECORDING),
    )
    text = status_channel.tick(
        state,
        room,
        driving(),
        10.016,
        frames_per_s=19.98,
        latency=LATENCY,
        tools={"arm1": (500, 250)},
        tool_view=ToolView((0.1, -0.5, -1.0), -0.85, (0.9, 0.4, 0.0, 0.0), 1.2),
    )
    assert json.loads(text) == {
        "type": "tick",
        "tick": 182,
        "sequence": 41,
        "rtf": 0.999,
        "engaged": False,
        "let_go": "",
        "gripper": 0.25,
        "gripper_set": 1,
        "hand_scale": 1.0,
        "holding": False,
        "phase": "recording",
        "ready": True,
        "practises_only": False,
        "partners": False,
        "others": True,
        "barrier": "stalled",
        "stopped_by": "",
        "paused_by_host": False,
        "waiting": [{"arm": "arm1", "since_s": 0.8}],
        "input": "phone",
        "phone": {"age_ms": 16, "tracking": True, "started": True},
        "rejected": {},
        "no_picture": "",
        "tools": {"arm1": [500, 250]},
        "view": {"tool": [0.1, -0.5, -1.0], "table": -0.85, "camera": [0.9, 0.4, 0.0, 0.0], "focal": 1.2},
        "fps": 20.0,
        "latency": {
            "p50_ms": 45.0,
            "p95_ms": 70.5,
            "stages": dict(zip(STAGES, range(len(STAGES)), strict=True)),
        },
    }


@pytest.mark.parametrize(
    ("no_picture", "stopped_by", "camera"),
    [
        ("x" * 1000, "\N{SNOWMAN}" * 64, ""),
        ("", "", ""),
        ("x" * 1000, "\N{SNOWMAN}" * 64, f"arm0-{'x' * 24}"),
        ("", "", "x" * 24),
    ],
    ids=["stopped", "driving", "camera, stopped", "camera"],
)
def test_the_longest_tick_message_fits_one_packet(no_picture: str, stopped_by: str, camera: str) -> None:
    hand = driving()
    hand._sources[InputDevice.PHONE].validator.rejected.update(dict.fromkeys(FrameRejection, 2**32))
    waiting = [Waiting(arm=f"arm{i}", since_s=29.99) for i in range(MAX_ARMS)]
    state = State(tick=2**32, real_time_factor=0.999, arms=[ArmState(arm="arm0", sequence=100)])
    slow = LatencySummary(9999.94, 9999.94, 300, (1999.94,) * len(STAGES))
    room = RoomStatus(barrier=BARRIER_PHASE_STALLED, waiting_for=waiting)
    room.stop.name = stopped_by
    text = status_channel.tick(
        state,
        room,
        hand,
        1e4,
        frames_per_s=119.9,
        latency=slow,
        no_picture=no_picture,
        camera=camera,
        tools={f"arm{index}": (1000, 1000) for index in range(MAX_ARMS)},
        tool_view=ToolView((-1.001,) * 3, -1.001, (-0.5001,) * 4, 1.2071),
    )
    assert len(text.encode()) <= status_channel.MAX_CHARACTERS, len(text.encode())


def test_who_speaks_fits_one_packet_however_they_are_called() -> None:
    speakers = [Speaker("🤖" * 32, "arm3")] * LANES
    text = status_channel.voices(speakers, is_heard=False)
    assert len(text.encode()) <= status_channel.MAX_CHARACTERS
    told = json.loads(text)
    assert told == {
        "type": "voices",
        "speakers": [{"arm": "arm3", "name": "🤖" * 32}] * LANES,
        "heard": False,
    }


def test_what_all_arms_say_fits_one_packet() -> None:
    said = [SaidCue(f"arm{index}", "🤖" * 24, "come_closer", 2**53) for index in range(MAX_ARMS)]
    text = status_channel.cues(said)
    assert len(text.encode()) <= status_channel.MAX_CHARACTERS
    assert json.loads(text)["said"][0] == {
        "arm": "arm0",
        "name": "🤖" * 24,
        "cue": "come_closer",
        "number": 2**53,
    }


def test_who_spoke_too_soon_is_told_which_press_was_not_said() -> None:
    refused = json.loads(status_channel.cue_refused(status_channel.CueMessage(CUE_WAIT, 7.5)))
    assert refused == {"type": "cue_refused", "cue": "wait", "t_us": 7.5}


@pytest.mark.parametrize(
    ("practice", "required", "passed", "practises_only"),
    [
        (False, False, False, False),
        (True, False, True, True),
        (False, True, False, True),
        (False, True, True, False),
    ],
)
def test_a_phone_is_told_where_nothing_is_recorded_with_its_person(
    practice: bool, required: bool, passed: bool, practises_only: bool
) -> None:
    seats = [Seat(arm="arm0", passed_course=passed), Seat(arm="arm1", operator=OPERATOR_SCRIPT)]
    room = RoomStatus(practice=practice, course_required=required, seats=seats)
    said = json.loads(status_channel.tick(State(), room, driving(), 10.0, frames_per_s=0, latency=None))
    assert (said["practises_only"], said["partners"]) == (practises_only, True)


def test_nothing_is_made_up_before_there_is_anything() -> None:
    said = json.loads(
        status_channel.tick(
            State(), RoomStatus(), Driving("arm0", 1, 1, Retarget(0.0)), 0.0, frames_per_s=0, latency=None
        )
    )
    assert said["latency"] is None
    assert said["phone"] is None
    assert said["sequence"] == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"type":"ping","t_us":12.5}', status_channel.PingMessage(12.5)),
        (
            '{"type":"clock","offset_ns":1800000000000000000}',
            status_channel.ClockMessage(1800000000000000000),
        ),
        ('{"type":"seen","tick":41,"t_us":12}', status_channel.SeenMessage(41, 12)),
        (
            '{"type":"drawing","on":true,"p50_ms":3,"p95_ms":5.5,"per_s":60}',
            status_channel.DrawingMessage(True, 3.0, 5.5, 60.0),
        ),
        ('{"type":"input","input":"keyboard"}', status_channel.SelectInputMessage(InputDevice.KEYBOARD)),
        ('{"type":"cue","cue":"wait","t_us":7.5}', status_channel.CueMessage(CUE_WAIT, 7.5)),
        ('{"type":"token","token":"a.b.c"}', status_channel.TokenMessage("a.b.c")),
    ],
)
def test_what_peers_say_is_understood(text: str, message: object) -> None:
    assert status_channel.parse(text) == message


@pytest.mark.parametrize(
    "text",
    [
        "",
        "null",
        "[]",
        "{",
        "[" * 1000,
        '{"type":"ping"}',
        '{"type":"ping","t_us":"1"}',
        '{"type":"ping","t_us":NaN}',
        '{"type":"ping","t_us":true}',
        '{"type":"clock","offset_ns":1e999}',
        '{"type":"drawing","on":1,"p50_ms":3,"p95_ms":5,"per_s":60}',
        '{"type":"drawing","on":true,"p50_ms":-1,"p95_ms":5,"per_s":60}',
        '{"type":"drawing","on":true,"p50_ms":1e9,"p95_ms":5,"per_s":60}',
        '{"type":"clock","offset_ns":1' + "0" * 400 + "}",
        '{"type":"seen","tick":1.5,"t_us":1}',
        '{"type":"seen","tick":1,"t_us":1e306}',
        '{"type":"seen","tick":1,"t_us":-1e306}',
        '{"type":"input","input":"mind"}',
        '{"type":"cue","cue":"hurry","t_us":1}',
        '{"type":"cue","cue":["go"],"t_us":1}',
        '{"type":"cue","cue":"go","t_us":true}',
        '{"type":"tick"}',
        '{"type":"ping","t_us":1,"more":"' + "x" * status_channel.MAX_CHARACTERS + '"}',
    ],
)
def test_nonsense_is_refused(text: str) -> None:
    with pytest.raises(InvalidInput):
        status_channel.parse(text)


@given(st.text(max_size=200) | st.binary(max_size=200))
def test_noise_is_refused_in_words(noise: str | bytes) -> None:
    with pytest.raises(InvalidInput):
        status_channel.parse(noise)


def test_a_ping_comes_back_as_it_was_sent() -> None:
    ping = status_channel.parse(status_channel.ping(123456.75))
    assert isinstance(ping, status_channel.PingMessage)
    assert json.loads(status_channel.pong(ping, 42)) == {"type": "pong", "t_us": 123456.75, "gateway_ns": 42}
    assert json.loads(status_channel.pong(ping, 42, 351_400.0))["picture_kbit_s"] == 351
    assert status_channel.parse(status_channel.clock_offset(-5)) == status_channel.ClockMessage(-5)


def test_an_arm_without_fingers_says_so() -> None:
    seats = [Seat(arm=arm) for arm in ("arm0", "arm1", "arm2")]

    def gripper(*kinds: str) -> float | None:
        room = RoomStatus(task="three_arm_lift_wiping", seats=seats, arm_kinds=kinds)
        hand = driving()
        hand.holding = True  # told to close, it stands still, as what holds something does
        told = json.loads(status_channel.tick(State(), room, hand, 10.0, frames_per_s=20.0, latency=None))
        assert told["holding"] == (told["gripper"] is not None)
        said: float | None = told["gripper"]
        return said

    assert gripper("ur5e+wiping_pad", "panda", "panda") is None
    assert gripper("ur5e+robotiq_2f85", "panda", "panda+wiping_pad") == 0.25
    assert gripper("of_another_machine", "panda", "panda") == 0.25
    assert gripper() == 0.25
