"""Write where an episode's bodies are in every tick: docs/protocol.md, "Motion". Pure: states in, bytes out."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable
from typing import BinaryIO, Protocol

import numpy as np

from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import State
from mart.recorder.catalogue.timeline import second_of

MAGIC = b"MMO1"
MAX_MOTION_BYTES = 16 * 1024 * 1024  # 16 minutes of two arms at 40 Hz; a page holds it whole
_HEADER = struct.Struct("<4sI")  # magic, bytes a row
_SECOND = struct.Struct("<d")
_STEP_M = struct.Struct("<16xf")  # of a message of poses


class Poses(Protocol):
    """What writes the poses of a state's bodies."""

    def message(self, integration_state: bytes, tick: int) -> bytes:
        """Return them, as many bytes each time; raises InvalidInput for a state of another model."""


def write_motion(states: Iterable[State], poses: Poses, control_hz: float | None, out: BinaryIO) -> None:
    """Write a row for each tick, one state in memory at a time; a state that is not finite has none.

    control_hz: seconds are simulated where it is given, else those of the wall's clock, as the timeline's are.
    Raises Corrupt for a state of another model and InvalidInput for an episode beyond 16 MiB.
    """
    first: State | None = None
    newest_tick, size_bytes = -1, 0
    for state in states:
        if state.tick <= newest_tick:  # written twice
            continue
        first, newest_tick = first or state, state.tick
        message = _message(state, poses)
        if size_bytes == 0:
            size_bytes = out.write(_HEADER.pack(MAGIC, _SECOND.size + len(message)))
        if not math.isfinite(*_STEP_M.unpack_from(message)):
            continue
        now_s = second_of(state, first.tick, first.stamps.stepped_ns, control_hz)
        size_bytes += out.write(_SECOND.pack(now_s) + message)
        if size_bytes > MAX_MOTION_BYTES:
            raise InvalidInput("This episode is too long to be shown in 3D here; draw it as a video.")


def _message(state: State, poses: Poses) -> bytes:
    try:
        with np.errstate(all="ignore"):  # of a world that flew apart
            return poses.message(state.integration_state, state.tick)
    except InvalidInput as error:
        raise Corrupt(f"The file's states are not of its model: {error}") from error
