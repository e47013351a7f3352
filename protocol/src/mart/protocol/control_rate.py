"""Say which control rates a room may have, in ticks a second; every door asks here."""

from __future__ import annotations

from mart.protocol.errors import InvalidInput

MIN_CONTROL_HZ = 5.0
MAX_CONTROL_HZ = 100.0
DEFAULT_CONTROL_HZ = 20.0
OFFERED_CONTROL_HZ = (20.0, 30.0, 60.0)  # what pages propose: screens and phones divide into them
LEARNING_CONTROL_HZ = 20.0  # at which is learned and exported where nothing else is asked for

_SAME = 1e-6  # of a rate: what rounding makes


def require_control_hz(control_hz: float) -> float:
    """Return `control_hz` where it is a rate that a room may have; raises InvalidInput elsewhere."""
    if not MIN_CONTROL_HZ <= control_hz <= MAX_CONTROL_HZ:
        raise InvalidInput(
            f"A control rate of {control_hz:g} Hz was given; "
            f"it must be from {MIN_CONTROL_HZ:g} to {MAX_CONTROL_HZ:g} Hz."
        )
    return control_hz


def same_control_hz(one_hz: float, other_hz: float) -> bool:
    """Whether two control rates are the same but for rounding."""
    return abs(one_hz - other_hz) <= _SAME * max(one_hz, other_hz)


def ticks_for_each(own_hz: float, room_hz: float) -> int:
    """Return how many ticks of a room of `room_hz` make one tick of something that has `own_hz`.

    Raises InvalidInput where the room's rate is no multiple of its own.
    """
    ticks = round(room_hz / own_hz)
    if ticks < 1 or not same_control_hz(ticks * own_hz, room_hz):
        raise InvalidInput(
            f"It acts {own_hz:g} times a second and the room ticks {room_hz:g} times; "
            f"the room's rate must be {own_hz:g} Hz or a multiple, such as {3 * own_hz:g} Hz."
        )
    return ticks
