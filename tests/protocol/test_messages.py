"""Golden bytes (the wire does not change by accident) and round trips of arbitrary messages."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

import numpy as np
import pytest
from google.protobuf.message import Message
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mart.protocol import messages as m
from mart.protocol.codec import decode, encode
from mart.protocol.errors import Conflict, InvalidInput, MartError, NotFound
from mart.protocol.pose import Pose
from tests.protocol.message_examples import arbitrary, examples

GOLDEN = json.loads((Path(__file__).parent / "golden" / "messages.json").read_text())
KINDS = sorted(examples())


@pytest.mark.parametrize("name", KINDS)
def test_golden_bytes(name: str) -> None:
    example = examples()[name]
    assert encode(example).hex() == GOLDEN[name]
    assert decode(type(example), bytes.fromhex(GOLDEN[name])) == example


def test_every_golden_message_still_exists() -> None:
    assert sorted(GOLDEN) == KINDS


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
@settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large], max_examples=25)
@given(data=st.data())
def test_any_message_survives_the_wire(name: str, data: st.DataObject) -> None:
    kind: type[Message] = type(examples()[name])
    message = data.draw(arbitrary(kind))
    assert decode(kind, encode(message)) == message


@given(st.binary(max_size=200))
def test_garbage_raises_nothing_but_invalid_input(payload: bytes) -> None:
    for example in examples().values():
        with contextlib.suppress(InvalidInput):
            decode(type(example), payload)


def test_what_is_no_message_is_refused_by_name() -> None:
    with pytest.raises(InvalidInput, match="5 bytes were given that are not a Command"):
        decode(m.Command, b"\xff" * 5)


def test_too_much_is_refused_before_it_is_parsed() -> None:
    with pytest.raises(InvalidInput, match="at most 10"):
        decode(m.Command, b"x" * 11, limit_bytes=10)


def test_a_pose_survives_its_message() -> None:
    pose = Pose.exp(np.array([0.1, -0.2, 0.3, 0.4, 0.5, -0.6]))
    back = m.pose_from_message(m.pose_message(pose))
    assert np.array_equal(back.position, pose.position)
    assert np.allclose(back.quaternion_wxyz, pose.quaternion_wxyz, atol=1e-15)


def test_an_empty_pose_message_is_refused() -> None:
    with pytest.raises(InvalidInput, match="norm"):
        m.pose_from_message(m.PoseMessage())


class NoSuchRoom(NotFound):
    """A subclass travels as its branch."""


@pytest.mark.parametrize("error", [Conflict("taken"), NoSuchRoom("none"), MartError("?")])
def test_an_error_survives_the_wire_as_its_branch(error: MartError) -> None:
    with pytest.raises(MartError, match=str(error).replace("?", r"\?")) as caught:
        m.raise_error(m.error_message(error))
    assert isinstance(error, type(caught.value))
    assert caught.value.code == error.code


def test_no_error_raises_nothing() -> None:
    m.raise_error(m.RoomReply().error)


def test_words_of_enums_go_both_ways() -> None:
    for word in ("human", "policy", "script", "hold", "generated"):
        assert m.operator_word(m.operator_from_word(word)) == word
    for word in ("success", "failure", "discarded"):
        assert m.outcome_word(m.outcome_from_word(word)) == word
    for word in ("have_it", "go", "wait", "slower", "thanks", "let_go", "come_closer"):
        assert m.cue_word(m.cue_from_word(word)) == word
    assert m.phase_word(m.EPISODE_PHASE_RECORDING) == "recording"
    assert m.barrier_word(m.BARRIER_PHASE_PAUSED) == "paused"
    for bad in ("unspecified", "robot", ""):
        with pytest.raises(InvalidInput, match="must be"):
            m.operator_from_word(bad)
        with pytest.raises(InvalidInput, match="must be"):
            m.outcome_from_word(bad)
        with pytest.raises(InvalidInput, match="have_it, go, wait, slower, thanks, let_go or come_closer"):
            m.cue_from_word(bad)
