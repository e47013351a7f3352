"""Tell times on from where they were when a wall clock was set anew meanwhile. Pure."""

from __future__ import annotations

_FORWARD_NS = 10_000_000_000  # less can be a machine that was busy
_BACK_NS = 1_000_000_000  # less can be messages that overtook one another


class SteadyTime:
    """Take leaps out of one sender's stamps, by a clock that ran beside.

    Of stamps that do not leap each stays as it is.
    """

    def __init__(self) -> None:
        self._before: tuple[int, int] | None = None
        self._shift_ns = 0

    def steady_ns(self, wall_ns: int, beside_ns: int) -> int:
        """Return a stamp (Unix time) as it would be had the clock not been set since the first one.

        beside_ns: of the same moment or a later one, on a clock of any beginning. A stamp that goes back by more than a
        second leaps, and so does one that goes on by ten seconds more than `beside_ns` does.
        """
        if self._before is not None:
            step_ns, beside_step_ns = wall_ns - self._before[0], beside_ns - self._before[1]
            if step_ns < -_BACK_NS or step_ns - beside_step_ns > _FORWARD_NS:
                self._shift_ns += max(0, beside_step_ns) - step_ns
        self._before = wall_ns, beside_ns
        return wall_ns + self._shift_ns
