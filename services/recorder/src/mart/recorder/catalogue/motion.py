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


def write_motion(
    states: Iterable[State], poses: Poses, control_hz: float | None, out: BinaryIO, ticks: int = 0
) -> None:
    """Write a row for each tick, one state in memory at a time; a state that is not finite has none.

    control_hz: seconds are simulated where it is given, else those of the wall's clock, as the timeline's are.
    ticks: how many there are, as the file says; where their rows were beyond 16 MiB, every second, third, … is written,
    and the last one.
    Raises Corrupt for a state of another model and InvalidInput where it comes to more than 16 MiB all the same.
    """
    first: State | None = None
    left_out: State | None = None
    newest_tick, rows = -1, _Rows(out, poses, control_hz, ticks)
    for state in states:
        if state.tick <= newest_tick:  # written twice
            continue
        first, newest_tick = first or state, state.tick
        left_out = None if rows.take(state, first) else state
    if left_out is not None and first is not None:
        rows.write(left_out, first)


class _Rows:
    """Write rows, as far apart as it takes for so many ticks."""

    def __init__(self, out: BinaryIO, poses: Poses, control_hz: float | None, ticks: int) -> None:
        self._out, self._poses, self._control_hz, self._ticks = out, poses, control_hz, ticks
        self._seen, self._every, self._size_bytes = 0, 1, 0

    def take(self, state: State, first: State) -> bool:
        """Write the row of a tick where it is its turn; returns whether it was."""
        self._seen += 1
        is_its_turn = (self._seen - 1) % self._every == 0
        if is_its_turn:
            self.write(state, first)
        return is_its_turn

    def write(self, state: State, first: State) -> None:
        """Write the row of a tick."""
        message = _message(state, self._poses)
        row_bytes = _SECOND.size + len(message)
        if self._size_bytes == 0:
            self._size_bytes = self._out.write(_HEADER.pack(MAGIC, row_bytes))
            self._every = max(1, math.ceil((self._ticks + 2) * row_bytes / (MAX_MOTION_BYTES - _HEADER.size)))
        if not math.isfinite(*_STEP_M.unpack_from(message)):
            return
        now_s = second_of(state, first.tick, first.stamps.stepped_ns, self._control_hz)
        self._size_bytes += self._out.write(_SECOND.pack(now_s) + message)
        if self._size_bytes > MAX_MOTION_BYTES:
            raise InvalidInput("This episode is too long to be shown in 3D here; draw it as a video.")


def _message(state: State, poses: Poses) -> bytes:
    try:
        with np.errstate(all="ignore"):  # of a world that flew apart
            return poses.message(state.integration_state, state.tick)
    except InvalidInput as error:
        raise Corrupt(f"The file's states are not of its model: {error}") from error
