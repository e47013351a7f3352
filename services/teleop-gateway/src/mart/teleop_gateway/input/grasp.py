"""Tell whether a gripper has taken hold of something, from what it was told and how far it came. Pure.

No sensor says so: a gripper that is told to close further and stands still has something between its fingers. The
thinnest thing in the tasks, a handle of 2 cm, leaves a gap of 0.25; closing on nothing, a gripper that is slow enough
to count as still has a gap of less than 0.02 left.
"""

from __future__ import annotations

from dataclasses import dataclass

_LEAST_GAP = 0.04  # of the whole stroke
_STILL_PER_S = 0.2  # strokes; it closes at 3.7 a second, and 10 times the gap a second at the end


@dataclass(frozen=True)
class GripperSample:
    """Hold how far a gripper is closed (`measured`) and was asked to close (`told`), 0 open … 1 closed."""

    measured: float
    told: float
    sim_time_s: float

    @property
    def gap(self) -> float:
        """Return how much further it would close; told half, it closes all the way, and the rest is force."""
        return min(1.0, 2.0 * self.told) - self.measured


def holds(held: bool, before: GripperSample | None, now: GripperSample) -> bool:
    """Tell whether something is held now. `held` is whether it was at `before`; None: nothing is known of then."""
    if now.gap < _LEAST_GAP:
        return False
    if before is None or now.sim_time_s < before.sim_time_s:
        return True
    elapsed_s = now.sim_time_s - before.sim_time_s
    return held or (elapsed_s > 0.0 and abs(now.measured - before.measured) < _STILL_PER_S * elapsed_s)
