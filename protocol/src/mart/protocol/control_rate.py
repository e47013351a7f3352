"""Say which control rates a room may have, in ticks a second; every door asks here."""

from __future__ import annotations

from mart.protocol.errors import InvalidInput

MIN_CONTROL_HZ = 5.0
MAX_CONTROL_HZ = 100.0
DEFAULT_CONTROL_HZ = 20.0
OFFERED_CONTROL_HZ = (20.0, 30.0, 60.0)  # what pages propose: screens and phones divide into them


def require_control_hz(control_hz: float) -> float:
    """Return `control_hz` where it is a rate that a room may have; raises InvalidInput elsewhere."""
    if not MIN_CONTROL_HZ <= control_hz <= MAX_CONTROL_HZ:
        raise InvalidInput(
            f"A control rate of {control_hz:g} Hz was given; "
            f"it must be from {MIN_CONTROL_HZ:g} to {MAX_CONTROL_HZ:g} Hz."
        )
    return control_hz
