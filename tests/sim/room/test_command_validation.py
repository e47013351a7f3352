"""The edge towards the bus: which commands are heard at all."""

from __future__ import annotations

import contextlib
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol import codec
from mart.protocol.messages import Command
from mart.protocol.received import MAX_COUNTER
from mart.sim.room.command_validation import (
    MAX_COMMAND_BYTES,
    CommandRejected,
    CommandRejection,
    validate_command,
)
from tests.sim.room.commands import command


def reason_for(message: Command, arm: str = "arm0") -> CommandRejection:
    with pytest.raises(CommandRejected) as caught:
        validate_command(codec.encode(message), arm, 0.0, 0)
    return caught.value.reason


def test_a_good_command_is_admitted_with_its_stamps() -> None:
    received = validate_command(codec.encode(command(sequence=7)), "arm0", 1.5, 99)
    assert (received.arm, received.sequence, received.at_s, received.at_wall_ns) == ("arm0", 7, 1.5, 99)
    assert received.target_tool_in_base.position.tolist() == [0.5, 0.0, 0.2]


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("field", ["x", "y", "z", "qw", "qx", "qy", "qz"])
def test_a_target_that_is_not_finite_is_rejected(field: str, number: float) -> None:
    message = command()
    setattr(message.target_tool_in_base, field, number)
    assert reason_for(message) is CommandRejection.NOT_FINITE


@pytest.mark.parametrize("gripper", [math.nan, math.inf])
def test_a_gripper_that_is_not_finite_is_rejected(gripper: float) -> None:
    message = command()
    message.gripper = gripper
    assert reason_for(message) is CommandRejection.NOT_FINITE


@pytest.mark.parametrize("norm", [0.0, 0.98, 1.02, 5.0])
def test_a_quaternion_off_the_unit_sphere_is_rejected(norm: float) -> None:
    message = command()
    message.target_tool_in_base.qx = norm
    assert reason_for(message) is CommandRejection.BAD_NORM


@pytest.mark.parametrize("norm", [0.991, 1.009])
def test_a_quaternion_within_one_percent_is_normalised(norm: float) -> None:
    message = command()
    message.target_tool_in_base.qx = norm
    received = validate_command(codec.encode(message), "arm0", 0.0, 0)
    assert received.target_tool_in_base.quaternion_wxyz.tolist() == [0.0, 1.0, 0.0, 0.0]


@pytest.mark.parametrize(("field", "value"), [("gripper", -0.1), ("gripper", 1.1)])
def test_a_gripper_out_of_range_is_rejected(field: str, value: float) -> None:
    message = command()
    setattr(message, field, value)
    assert reason_for(message) is CommandRejection.OUT_OF_BOUNDS


def test_a_target_far_away_is_rejected() -> None:
    message = command()
    message.target_tool_in_base.y = 1e300
    assert reason_for(message) is CommandRejection.OUT_OF_BOUNDS


def test_the_command_of_another_arm_is_rejected() -> None:
    assert reason_for(command("arm1"), arm="arm0") is CommandRejection.UNKNOWN_ARM


def test_a_payload_that_is_too_long_is_malformed() -> None:
    with pytest.raises(CommandRejected) as caught:
        validate_command(bytes(MAX_COMMAND_BYTES + 1), "arm0", 0.0, 0)
    assert caught.value.reason is CommandRejection.MALFORMED


@given(st.binary(max_size=200))
def test_any_bytes_are_admitted_or_rejected(payload: bytes) -> None:
    with contextlib.suppress(CommandRejected):
        assert validate_command(payload, "arm0", 0.0, 0).arm == "arm0"


@pytest.mark.parametrize("sequence", [MAX_COUNTER + 1, 2**64 - 1])
def test_a_number_after_which_there_are_none_is_rejected(sequence: int) -> None:
    message = command("arm0", epoch=1, sequence=sequence)
    assert reason_for(message) is CommandRejection.LEAP
