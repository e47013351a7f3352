"""Read and write the status channel: JSON, one small object a message. docs/protocol.md, "Status channel"."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from mart.protocol.errors import InvalidInput
from mart.protocol.messages import (
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    OPERATOR_SCRIPT,
    Cue,
    RoomStatus,
    State,
    barrier_word,
    cue_from_word,
    cue_word,
    phase_word,
)
from mart.protocol.room_task import has_fingers
from mart.teleop_gateway.input.driving import Driving, InputDevice, PhoneState
from mart.teleop_gateway.video.motion_to_photon import STAGES, LatencySummary
from mart.teleop_gateway.video.tool_projection import ToolPlaces, ToolView
from mart.teleop_gateway.voice.lanes import Speaker
from mart.teleop_gateway.webrtc.said_cues import SaidCue

MAX_CHARACTERS = 1200  # one SCTP packet
_LARGEST = 2**63 - 1
_LONGEST_DRAW_MS = 60_000
_NAME_CHARACTERS = 24
_REASON_CHARACTERS = 78
_DRIVING = (OPERATOR_HUMAN, OPERATOR_POLICY, OPERATOR_SCRIPT)


@dataclass(frozen=True)
class PingMessage:
    """Ask for the gateway's time. `t_us` is the sender's own clock."""

    t_us: float


@dataclass(frozen=True)
class ClockMessage:
    """Tell the gateway's clock minus the sender's, nanoseconds."""

    offset_ns: int


@dataclass(frozen=True)
class SeenMessage:
    """Tell when a tick was displayed, on the sender's clock."""

    tick: int
    t_us: float


@dataclass(frozen=True)
class DrawingMessage:
    """Tell whether the sender's page draws by itself, and what a draw takes it: milliseconds, draws a second.

    0 ms: it has not measured. A page that tried and was too slow tells its figures too.
    """

    on: bool
    p50_ms: float
    p95_ms: float
    per_s: float


@dataclass(frozen=True)
class SelectInputMessage:
    """Ask for this device to drive."""

    input: InputDevice


@dataclass(frozen=True)
class ChooseCameraMessage:
    """Ask for the camera with this id to be shown at the seat."""

    camera: str


@dataclass(frozen=True)
class CueMessage:
    """Give a word to the partners. `press_us`, the sender's clock, names the press, which is told several times."""

    cue: Cue
    press_us: float


@dataclass(frozen=True)
class TokenMessage:
    """Show a newer seat token, with which one may speak on."""

    token: str


PeerMessage = (
    PingMessage
    | ClockMessage
    | SeenMessage
    | DrawingMessage
    | SelectInputMessage
    | ChooseCameraMessage
    | CueMessage
    | TokenMessage
)


def parse(text: str | bytes) -> PeerMessage:
    """Return what a peer's message says; raises InvalidInput for anything that is none of these."""
    if len(text) > MAX_CHARACTERS:
        raise InvalidInput(
            f"A status message of {len(text)} characters was given; {MAX_CHARACTERS} are allowed."
        )
    try:
        return _parsed(json.loads(text))
    except (ValueError, OverflowError, RecursionError) as error:
        raise InvalidInput(f"A status message was given that cannot be read: {error}.") from error


def _parsed(message: object) -> PeerMessage:
    parsed: PeerMessage
    match message:
        case {"type": "ping", "t_us": t_us}:
            parsed = PingMessage(_finite(t_us))
        case {"type": "clock", "offset_ns": offset_ns}:
            parsed = ClockMessage(int(_finite(offset_ns)))
        case {"type": "seen", "tick": int(tick), "t_us": t_us} if 0 <= tick <= _LARGEST:
            parsed = SeenMessage(tick, _finite(t_us))
        case {"type": "drawing", "on": bool(on), "p50_ms": p50, "p95_ms": p95, "per_s": per_s}:
            parsed = DrawingMessage(on, *(_bounded(value) for value in (p50, p95, per_s)))
        case {"type": "input", "input": name}:
            parsed = SelectInputMessage(InputDevice(name))
        case {"type": "camera", "camera": str(camera)}:
            parsed = ChooseCameraMessage(camera)
        case {"type": "cue", "cue": str(word), "t_us": t_us}:
            parsed = CueMessage(cue_from_word(word), _finite(t_us))
        case {"type": "token", "token": str(token)}:
            parsed = TokenMessage(token)
        case _:
            raise ValueError("it is none of ping, clock, seen, drawing, input, camera, cue and token")
    return parsed


def pong(ping: PingMessage, gateway_ns: int, limit_bps: float = math.inf) -> str:
    """Return the answer to a ping, with how many bits a second of pictures the peer's link carries, where it limits."""
    limit = {} if math.isinf(limit_bps) else {"picture_kbit_s": round(limit_bps * 1e-3)}
    return _text({"type": "pong", "t_us": ping.t_us, "gateway_ns": gateway_ns, **limit})


def replaced() -> str:
    """Return the word to a driving peer whose place a newer one takes: it need not try again by itself."""
    return _text({"type": "replaced"})


def voices(speakers: Sequence[Speaker], *, is_heard: bool) -> str:
    """Return who speaks now, and whether the peer is heard where it does."""
    told = [{"arm": speaker.arm, "name": speaker.name} for speaker in speakers]
    return _text({"type": "voices", "speakers": told, "heard": is_heard})


def cues(said: Sequence[SaidCue]) -> str:
    """Return what the drivers of the room's arms say to each other now."""
    told = [{"arm": one.arm, "name": one.name, "cue": one.cue, "number": one.number} for one in said]
    return _text({"type": "cues", "said": told})


def cue_refused(message: CueMessage) -> str:
    """Return the word to whoever gave cues too soon after each other that this one was not said."""
    return _text({"type": "cue_refused", "cue": cue_word(message.cue), "t_us": message.press_us})


def ping(t_us: float) -> str:
    """Return a peer's question for the gateway's time."""
    return _text({"type": "ping", "t_us": t_us})


def clock_offset(offset_ns: int) -> str:
    """Return a peer's word of the gateway's clock minus its own, nanoseconds."""
    return _text({"type": "clock", "offset_ns": offset_ns})


def tick(
    state: State,
    room: RoomStatus,
    driving: Driving,
    now_s: float,
    *,
    frames_per_s: float,
    latency: LatencySummary | None,
    no_picture: str = "",
    camera: str = "",
    tools: ToolPlaces = MappingProxyType({}),
    tool_view: ToolView | None = None,
) -> str:
    """Return what a page shows, at most MAX_CHARACTERS long: of a picture that is not there, or stands, no view.

    Of a real camera, which hangs nobody knows where, neither view nor tools.
    """
    if no_picture or room.stop.name or camera:
        tool_view = None
    if camera:
        tools = {}
    sequence = next((arm.sequence for arm in state.arms if arm.arm == driving.arm), 0)
    phone, grips = driving.phone(now_s), has_fingers(room, driving.arm)
    return _text(
        {
            "type": "tick",
            "tick": state.tick,
            "sequence": driving.frame_number(sequence) or 0,
            "rtf": round(state.real_time_factor, 3),
            "engaged": driving.engaged(now_s),
            "let_go": driving.let_go(now_s) or "",
            "gripper": round(driving.gripper, 3) if grips else None,
            "gripper_set": driving.gripper_set,
            "holding": driving.holding and grips,
            "hand_scale": driving.retarget.scale,
            "phase": phase_word(room.episode.phase),
            "ready": any(seat.ready for seat in room.seats if seat.arm == driving.arm),
            "practises_only": _practises_only(room, driving.arm),
            "partners": any(seat.operator in _DRIVING for seat in room.seats if seat.arm != driving.arm),
            "others": any(seat.operator != OPERATOR_HUMAN for seat in room.seats if seat.arm != driving.arm),
            "barrier": barrier_word(room.barrier),
            "stopped_by": room.stop.name[:_NAME_CHARACTERS],
            "paused_by_host": room.stop.by_host,
            "waiting": [{"arm": w.arm, "since_s": round(w.since_s, 2)} for w in room.waiting_for],
            "input": driving.active.value,
            "phone": phone and _phone(phone),
            "rejected": dict(driving.rejected()),
            "no_picture": no_picture[:_REASON_CHARACTERS],
            **({"camera": camera} if camera else {}),
            "tools": dict(tools),
            **({"view": _view(tool_view)} if tool_view else {}),
            "fps": round(frames_per_s, 1),
            "latency": latency and _latency(latency),
        }
    )


def _practises_only(room: RoomStatus, arm: str) -> bool:
    """Whether nothing is recorded here, or not with whoever holds this seat."""
    passed = any(seat.passed_course for seat in room.seats if seat.arm == arm)
    return room.practice or (room.course_required and not passed)


def _phone(phone: PhoneState) -> dict[str, Any]:
    return {"age_ms": round(1e3 * phone.age_s), "tracking": phone.tracking, "started": phone.started}


def _view(view: ToolView) -> dict[str, Any]:
    return {"tool": view.tool_m, "table": view.table_m, "camera": view.camera_wxyz, "focal": view.focal}


def _latency(summary: LatencySummary) -> dict[str, Any]:
    return {
        "p50_ms": round(summary.p50_ms, 1),
        "p95_ms": round(summary.p95_ms, 1),
        "stages": {name: round(ms, 1) for name, ms in zip(STAGES, summary.stages, strict=True)},
    }


def _text(message: dict[str, Any]) -> str:
    return json.dumps(message, separators=(",", ":"), ensure_ascii=False)


def _finite(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= _LARGEST:
        raise ValueError(f"{value!r} is no finite number of at most 63 bits")
    return value


def _bounded(value: Any) -> float:
    if not 0 <= _finite(value) <= _LONGEST_DRAW_MS:
        raise ValueError(f"{value!r} is not between 0 and {_LONGEST_DRAW_MS}")
    return float(value)
