"""Measure how well time was kept, from when ticks fired. Pure."""

from __future__ import annotations

from array import array

import numpy as np

from mart.episodes.steady_time import SteadyTime
from mart.protocol.messages import State
from mart.protocol.recording import CadenceRecord

_MAX_NS = 2**62  # of the year 2116


class TickClock:
    """Keep when ticks fired. The first state of an episode is a reset and no tick, so it does not count.

    A room's clock that is set anew meanwhile makes no tick longer or shorter.
    """

    def __init__(self) -> None:
        self._fired_ns = array("q")
        self._sim_s = array("d")
        self._steady = SteadyTime()

    def add(self, state: State, arrived_ns: int) -> None:
        """Take a state. arrived_ns: when it came (Unix time)."""
        if state.episode_tick > 0 and 0 < state.stamps.fired_ns <= _MAX_NS:
            self._fired_ns.append(self._steady.steady_ns(state.stamps.fired_ns, arrived_ns))
            self._sim_s.append(state.sim_time_s)

    def cadence(self, **known: object) -> CadenceRecord:
        """Return the record `mart.cadence`. known: its fields that ticks do not tell."""
        if len(self._fired_ns) < 2:
            return CadenceRecord(wall_s=0.0, sim_s=0.0, **known)
        fired_ns = np.array(self._fired_ns, dtype=np.int64)
        intervals_ms = np.diff(fired_ns) / 1e6
        wall_s = float(fired_ns[-1] - fired_ns[0]) / 1e9
        sim_s = self._sim_s[-1] - self._sim_s[0]
        return CadenceRecord(
            real_time_factor=sim_s / wall_s if wall_s > 0 else None,
            wall_s=wall_s,
            sim_s=sim_s,
            tick_interval_p50_ms=float(np.percentile(intervals_ms, 50)),
            tick_interval_p95_ms=float(np.percentile(intervals_ms, 95)),
            tick_interval_max_ms=float(intervals_ms.max()),
            **known,
        )
