"""Measure how well time was kept, from when ticks fired. Pure."""

from __future__ import annotations

from array import array

import numpy as np

from mart.protocol.messages import State
from mart.protocol.recording import CadenceRecord


class TickClock:
    """Keep when ticks fired. The first state of an episode is a reset and no tick, so it does not count."""

    def __init__(self) -> None:
        self._fired_ns = array("Q")
        self._sim_s = array("d")

    def add(self, state: State) -> None:
        """Take a state."""
        if state.episode_tick > 0 and state.stamps.fired_ns:
            self._fired_ns.append(state.stamps.fired_ns)
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
