"""Check what came over the bus before anybody acts on it, whoever sent it.

A payload that parses may still say what no part of this version can have said: a member that its enumeration does not
have, a number that is not finite or stands at the limit of its type, a text or a list without end. `decode_received`
refuses it at the door, in one place, so that no part has to expect it. Files are read with `codec.decode`: they hold
what was recorded, perhaps by a newer version.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from google.protobuf.descriptor import Descriptor, FieldDescriptor
from google.protobuf.message import Message

from mart.protocol import codec, keys
from mart.protocol.errors import InvalidInput

M = TypeVar("M", bound=Message)

MAX_COUNTER = 2**53  # of ticks, sequences, epochs: what a page's number still holds exactly
MAX_NUMBER = 2**31 - 1  # of episodes and their ticks
MAX_TEXT_CHARACTERS = 4096
MAX_LIST_ITEMS = 4096
MAX_CONTROL_HZ = 1000.0

# What is said again and again, to everybody. Questions and answers have bounds where they are handled.
_SPOKEN = frozenset(
    {
        "Command",
        "State",
        "RoomStatus",
        "Event",
        "RecordingReport",
        "SeatRequest",
        "EpisodeRequest",
        "RoomsRequest",
        "VoicePacket",
        "ArmTarget",
        "ArmMeasured",
        "CameraFrame",
        "CameraReport",
        "DriverHello",
    }
)
# Said at every tick: looking at each name would take half of what looking at the numbers takes.
_BOUNDED_BY_SIZE = frozenset({"mart/v1/state.proto", "mart/v1/command.proto"})
_COUNTERS = frozenset(
    {"tick", "last_tick", "seen_tick", "sequence", "seat_epoch", "epoch", "session", "follows_tick"}
)
_NUMBERS = frozenset({"number", "episode", "episode_tick", "ticks", "episodes_saved", "episodes_good"})

_Check = Callable[[Any], str | None]  # a field's value → what is wrong with it
_Plan = tuple[tuple[str, bool, "_Check"], ...]  # field, whether to look for its presence, its check


def decode_received(kind: type[M], payload: bytes, limit_bytes: int = codec.MAX_MESSAGE_BYTES) -> M:
    """Return the message. Raises InvalidInput as `codec.decode`, and where it says what cannot be meant."""
    message = codec.decode(kind, payload, limit_bytes)
    objection = _objection(message, _plan(kind.DESCRIPTOR, kind.DESCRIPTOR.name in _SPOKEN))
    if objection is not None:
        raise InvalidInput(f"A {kind.DESCRIPTOR.name} was given whose {objection}.")
    return message


def require_room(message: Message, key: str) -> None:
    """Raise InvalidInput where a message that names its room came under the key of another."""
    room = getattr(message, "room", None)
    if room is not None and room != keys.room_of(key):
        raise InvalidInput(f"A message of room {room[:64]!r} was sent under {key}.")


def _objection(message: Message, plan: _Plan) -> str | None:
    for name, may_be_absent, check in plan:
        if may_be_absent and not message.HasField(name):
            continue
        wrong = check(getattr(message, name))
        if wrong is not None:
            return f"{name}{wrong}"
    return None


@functools.cache
def _plan(descriptor: Descriptor, spoken: bool) -> _Plan:
    found: list[tuple[str, bool, _Check]] = []
    bounded = descriptor.file.name in _BOUNDED_BY_SIZE
    for field in descriptor.fields:
        check = _field_check(field, spoken)
        if check is not None and not (check is _check_text and bounded):
            single = field.message_type is not None and not field.is_repeated
            found.append((field.name, single, _each(check, spoken) if field.is_repeated else check))
    return tuple(found)


def _each(check: _Check, spoken: bool) -> _Check:
    if check is _check_finite:
        return _check_all_finite

    def check_each(values: Sequence[Any]) -> str | None:
        if spoken and len(values) > MAX_LIST_ITEMS:
            return f" has {len(values)} items; {MAX_LIST_ITEMS} are allowed"
        for value in values:
            wrong = check(value)
            if wrong is not None:
                return wrong
        return None

    return check_each


def _field_check(field: FieldDescriptor, spoken: bool) -> _Check | None:
    if field.message_type is not None:
        return None if field.message_type.GetOptions().map_entry else _message_check(field, spoken)
    if field.enum_type is not None:
        return _enum_check(frozenset(field.enum_type.values_by_number))
    return _scalar_check(field) if spoken else None


def _scalar_check(field: FieldDescriptor) -> _Check | None:
    if field.cpp_type == FieldDescriptor.CPPTYPE_DOUBLE:
        return _check_control_hz if field.name == "control_hz" else _check_finite
    if field.type == FieldDescriptor.TYPE_STRING:
        return _check_text
    most = MAX_COUNTER if field.name in _COUNTERS else MAX_NUMBER if field.name in _NUMBERS else None
    return None if most is None else _at_most(most)


def _message_check(field: FieldDescriptor, spoken: bool) -> _Check | None:
    plan = _plan(field.message_type, spoken)
    if not plan:
        return None

    def check(message: Any) -> str | None:
        wrong = _objection(message, plan)
        return None if wrong is None else f".{wrong}"

    return check


def _enum_check(known: frozenset[int]) -> _Check:
    def check(value: int) -> str | None:
        return None if value in known else f" is {value}, which this version does not know"

    return check


def _at_most(most: int) -> _Check:
    def check(value: int) -> str | None:
        return None if value <= most else f" is {value}; at most {most} is allowed"

    return check


def _check_finite(value: float) -> str | None:
    return None if math.isfinite(value) else f" is {value}; it must be finite"


def _check_all_finite(values: Sequence[float]) -> str | None:
    return None if all(map(math.isfinite, values)) else " holds a number that is not finite"


def _check_control_hz(value: float) -> str | None:
    return None if 0.0 <= value <= MAX_CONTROL_HZ else f" is {value}; it must be in [0, {MAX_CONTROL_HZ:g}]"


def _check_text(value: str) -> str | None:
    return (
        None
        if len(value) <= MAX_TEXT_CHARACTERS
        else f" has {len(value)} characters; {MAX_TEXT_CHARACTERS} are allowed"
    )
