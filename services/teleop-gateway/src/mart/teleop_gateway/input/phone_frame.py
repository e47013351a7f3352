"""Encode and decode the phone frame: 60 bytes that say everything a hand says, 60 times a second.

The layout is specified in docs/protocol.md, "Phone frame"; golden bytes shared with the page's encoder are in
tests/teleop_gateway/golden/phone_frame.json.
"""

from __future__ import annotations

import enum
import struct
from dataclasses import dataclass

from mart.protocol.errors import InvalidInput

MAGIC = b"MPF1"
_LAYOUT = struct.Struct("<4sIIIQ3f4ffHH")
SIZE_BYTES = _LAYOUT.size


class Flag(enum.IntFlag):
    """Name the bits of a frame's flags."""

    CLUTCH = 1  # held
    TRACKING = 2  # good
    EMERGENCY_STOP = 4  # held
    ORIENTATION_ONLY = 8  # the position is a touch pad's, aligned with the screen
    SCREEN_ALIGNED = 16  # position and orientation are aligned with the screen already


class MalformedFrame(InvalidInput):
    """Tell that bytes are no phone frame."""


@dataclass(frozen=True)
class PhoneFrame:
    """Hold one frame as it was sent; nothing about its numbers has been checked.

    position: metres, in the phone's session frame (x right, y up, z towards the person). gripper: 0 open … 1 closed.
    sent_us: the sender's own clock.
    """

    seat_epoch: int
    sequence: int
    seen_tick: int
    sent_us: int
    position: tuple[float, float, float]
    quaternion_wxyz: tuple[float, float, float, float]
    gripper: float
    flags: Flag

    def encode(self) -> bytes:
        """Return the frame's 60 bytes."""
        return _LAYOUT.pack(
            MAGIC,
            self.seat_epoch,
            self.sequence,
            self.seen_tick,
            self.sent_us,
            *self.position,
            *self.quaternion_wxyz,
            self.gripper,
            self.flags,
            0,
        )

    @classmethod
    def decode(cls, payload: bytes) -> PhoneFrame:
        """Return the frame in 60 bytes; bits and bytes kept for later are ignored. Raises MalformedFrame."""
        if len(payload) != SIZE_BYTES:
            raise MalformedFrame(f"{len(payload)} bytes were given; a phone frame has {SIZE_BYTES}.")
        magic, epoch, sequence, seen_tick, sent_us, *numbers, flags, _ = _LAYOUT.unpack(payload)
        if magic != MAGIC:
            raise MalformedFrame(
                f"A frame starting with {magic!r} was given; a phone frame starts with {MAGIC!r}."
            )
        x, y, z, qw, qx, qy, qz, gripper = numbers
        known = Flag(flags & _EVERY_FLAG)
        return cls(epoch, sequence, seen_tick, sent_us, (x, y, z), (qw, qx, qy, qz), gripper, known)


_EVERY_FLAG = sum(Flag)
