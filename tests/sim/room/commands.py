"""Commands as they arrive, for the sim's tests."""

from __future__ import annotations

from mart.protocol import codec
from mart.protocol.messages import Command, PoseMessage
from mart.sim.room.command_validation import ReceivedCommand, validate_command

SECOND_NS = 1_000_000_000


def command(arm: str = "arm0", epoch: int = 1, sequence: int = 1, stop: bool = False) -> Command:
    """A good one: the tool half a metre ahead of the base, pointing down."""
    return Command(
        arm=arm,
        seat_epoch=epoch,
        sequence=sequence,
        target_tool_in_base=PoseMessage(x=0.5, y=0.0, z=0.2, qw=0.0, qx=1.0),
        gripper=0.5,
        engaged=True,
        emergency_stop=stop,
    )


def received(
    arm: str = "arm0", epoch: int = 1, sequence: int = 1, at_s: float = 0.0, stop: bool = False
) -> ReceivedCommand:
    payload = codec.encode(command(arm, epoch, sequence, stop))
    return validate_command(payload, arm, at_s, round(at_s * SECOND_NS))
