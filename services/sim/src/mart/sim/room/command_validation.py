"""Validate commands as they come from the bus: what one must look like to be heard at all. Pure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from mart.protocol import codec
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import Command, PoseMessage
from mart.protocol.pose import Pose
from mart.protocol.received import MAX_COUNTER

MAX_COMMAND_BYTES = 1024  # a full command has about 200
MAX_COORDINATE_M = 100.0
_NORM_TOLERANCE = 0.01


class CommandRejection(StrEnum):
    """Name why a command was not used."""

    MALFORMED = "not a command"
    UNKNOWN_ARM = "unknown arm"
    FREE_SEAT = "nobody's seat"
    WRONG_EPOCH = "wrong seat epoch"
    OLD_SEQUENCE = "old sequence"
    LEAP = "sequence leaps"
    NOT_FINITE = "number not finite"
    BAD_NORM = "quaternion not of unit norm"
    OUT_OF_BOUNDS = "out of bounds"
    OLD_STATE = "made from an old state"
    WAITED = "waited on its way"


class CommandRejected(InvalidInput):
    """Refuse a command that cannot be used, whoever holds the seat; `reason` says why."""

    def __init__(self, reason: CommandRejection) -> None:
        super().__init__(f"A command was rejected: {reason}.")
        self.reason = reason


@dataclass(frozen=True)
class ReceivedCommand:
    """Hold a well-formed command and when it came: monotonic seconds to decide, wall nanoseconds to record."""

    command: Command
    target_tool_in_base: Pose
    at_s: float
    at_wall_ns: int

    @property
    def arm(self) -> str:
        """The arm that the command is for."""
        return self.command.arm

    @property
    def seat_epoch(self) -> int:
        """The epoch of the seat under which it was given."""
        return self.command.seat_epoch

    @property
    def sequence(self) -> int:
        """Its number; a later command of the same seat has a greater one."""
        return self.command.sequence

    @property
    def emergency_stop(self) -> bool:
        """Whether it holds the emergency stop."""
        return self.command.emergency_stop


def validate_command(payload: bytes, arm: str, at_s: float, at_wall_ns: int) -> ReceivedCommand:
    """Return the command in `payload`, which came on the key of `arm`; raises CommandRejected with the reason."""
    try:
        command = codec.decode(Command, payload, MAX_COMMAND_BYTES)
    except InvalidInput as error:
        raise CommandRejected(CommandRejection.MALFORMED) from error
    if command.arm != arm:
        raise CommandRejected(CommandRejection.UNKNOWN_ARM)
    if command.sequence > MAX_COUNTER:
        raise CommandRejected(CommandRejection.LEAP)
    reason = _objection(command.target_tool_in_base, command.gripper)
    if reason is not None:
        raise CommandRejected(reason)
    target = command.target_tool_in_base
    pose = Pose(
        np.array((target.x, target.y, target.z)), np.array((target.qw, target.qx, target.qy, target.qz))
    )
    return ReceivedCommand(command, pose, at_s, at_wall_ns)


def _objection(target: PoseMessage, gripper: float) -> CommandRejection | None:
    position = (target.x, target.y, target.z)
    quaternion = (target.qw, target.qx, target.qy, target.qz)
    if not all(map(math.isfinite, (*position, *quaternion, gripper))):
        return CommandRejection.NOT_FINITE
    if abs(math.hypot(*quaternion) - 1.0) > _NORM_TOLERANCE:
        return CommandRejection.BAD_NORM
    if max(map(abs, position)) > MAX_COORDINATE_M or not 0.0 <= gripper <= 1.0:
        return CommandRejection.OUT_OF_BOUNDS
    return None
