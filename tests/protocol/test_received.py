"""What nobody can have meant is refused where it arrives."""

from __future__ import annotations

import math
from typing import Any

import pytest
from google.protobuf.message import Message
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol import codec
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import (
    Command,
    EpisodeRequest,
    Event,
    RoomReply,
    RoomStatus,
    Seat,
    SeatRequest,
    State,
    TrainerReply,
)
from mart.protocol.received import (
    MAX_COUNTER,
    MAX_LIST_ITEMS,
    MAX_NUMBER,
    MAX_TEXT_CHARACTERS,
    decode_received,
)
from tests.protocol.message_examples import examples

_EXAMPLES = examples()


def _with(name: str, **changes: Any) -> Message:
    message = type(_EXAMPLES[name])()
    message.CopyFrom(_EXAMPLES[name])
    for path, value in changes.items():
        *way, last = path.split("__")
        target: Any = message
        for step in way:
            target = target[int(step)] if step.isdigit() else getattr(target, step)
        setattr(target, last, value)
    return message


def _enum(number: int) -> Any:
    return number


@pytest.mark.parametrize("name", _EXAMPLES)
def test_what_parts_say_passes(name: str) -> None:
    message = _EXAMPLES[name]
    assert decode_received(type(message), codec.encode(message)) == message


@pytest.mark.parametrize(
    ("message", "word"),
    [
        (_with("RoomStatus", barrier=77), "barrier is 77"),
        (_with("RoomStatus", seats__0__operator=77), "seats.operator is 77"),
        (_with("RoomStatus", episode__phase=9), "episode.phase is 9"),
        (_with("State", arms__0__source=77), "arms.source is 77"),
        (_with("State", tick=2**64 - 1), "tick is"),
        (_with("State", tick=MAX_COUNTER + 1), "tick is"),
        (_with("State", episode=2**32 - 1), "episode is"),
        (_with("State", episode_tick=MAX_NUMBER + 1), "episode_tick is"),
        (_with("State", arms__0__tool_in_base__x=math.nan), "x is nan"),
        (_with("State", sim_time_s=math.inf), "sim_time_s is inf"),
        (_with("RoomStatus", real_time_factor=math.nan), "real_time_factor"),
        (_with("RoomStatus", control_hz=-1.0), "control_hz"),
        (_with("RoomStatus", control_hz=math.nan), "control_hz"),
        (_with("RoomStatus", seats__0__name="a" * (MAX_TEXT_CHARACTERS + 1)), "seats.name has"),
        (_with("Command", sequence=2**64 - 1), "sequence is"),
        (_with("Command", source=6), "source is 6"),
        (State(observations=[{"name": "a", "value": [0.0, math.nan]}]), "value holds"),
        (RoomStatus(seats=[Seat()] * (MAX_LIST_ITEMS + 1)), "items"),
        (Event(cue_given=Event.CueGiven(cue=_enum(99))), "cue_given.cue is 99"),
        (Event(episode_saved=Event.EpisodeSaved(number=2**32 - 1)), "number is"),
        (EpisodeRequest(ready=EpisodeRequest.Ready(number=2**32 - 1)), "number is"),
        (SeatRequest(claim=SeatRequest.Claim(operator=_enum(9))), "operator is 9"),
        (RoomReply(status=RoomStatus(barrier=_enum(77))), "status.barrier is 77"),
    ],
)  # fmt: skip
def test_what_nobody_can_have_meant_is_refused(message: Message, word: str) -> None:
    with pytest.raises(InvalidInput, match=word):
        decode_received(type(message), codec.encode(message))


def test_an_answer_may_hold_a_number_that_is_not_finite() -> None:
    """A training's loss may be none."""
    reply = TrainerReply(jobs=[{"id": "job-0001", "progress": {"loss": math.nan}}])
    assert math.isnan(decode_received(TrainerReply, codec.encode(reply)).jobs[0].progress.loss)


@given(data=st.data())
def test_a_flipped_bit_is_refused_or_stays_within_bounds(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(["State", "RoomStatus", "Event", "Command", "SeatRequest"]))
    payload = bytearray(codec.encode(_EXAMPLES[name]))
    for place in data.draw(st.lists(st.integers(0, len(payload) * 8 - 1), min_size=1, max_size=4)):
        payload[place // 8] ^= 1 << place % 8
    try:
        message = decode_received(type(_EXAMPLES[name]), bytes(payload))
    except InvalidInput:
        return
    if isinstance(message, State | Command | RoomStatus | Event):
        codec.encode(message)
    if isinstance(message, State | RoomStatus | Event):
        assert message.tick <= MAX_COUNTER
