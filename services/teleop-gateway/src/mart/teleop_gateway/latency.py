"""Motion to photon: from the moment a hand's frame was sent to the moment its effect was on the screen.

Pure. Every stamp is Unix time in nanoseconds on this machine's clock; the peers' own stamps have been mapped by their
clock offsets. A tick's stamps are collected on the way; a page's report of the displayed tick closes the account.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from mart.protocol.messages import Event, State

STAGES = (
    "input → gateway",
    "gateway → sim",
    "tick wait",
    "physics",
    "sim → gateway",
    "render",
    "encode",
    "send → displayed",
)
T = TypeVar("T")

_MS_PER_NS = 1e-6
_LONGEST_NS = 10_000_000_000


@dataclass(frozen=True)
class PictureStamps:
    """One tick's way through the gateway."""

    state_received_ns: int
    rendered_ns: int
    encoded_ns: int


@dataclass(frozen=True)
class Summary:
    """Of the newest reports; `stages`: median milliseconds of each of STAGES, in order."""

    p50_ms: float
    p95_ms: float
    frames: int
    stages: tuple[float, ...]

    def __str__(self) -> str:
        stages = ", ".join(f"{name} {ms:.1f}" for name, ms in zip(STAGES, self.stages, strict=True))
        return f"p50 {self.p50_ms:.1f} ms, p95 {self.p95_ms:.1f} ms of {self.frames} pictures ({stages})"

    def event(self, arm: str) -> Event.Latency:
        named = [Event.Latency.Stage(name=n, p50_ms=ms) for n, ms in zip(STAGES, self.stages, strict=True)]
        return Event.Latency(
            arm=arm, p50_ms=self.p50_ms, p95_ms=self.p95_ms, frames=self.frames, stages=named
        )


class MotionToPhoton:
    """Keeps the last `window` reports of one arm."""

    def __init__(self, arm: str, window: int = 300, ticks: int = 256) -> None:
        self.reports = 0  # in all
        self._arm = arm
        self._ticks = ticks
        self._until_state: dict[int, tuple[int, ...]] = {}
        self._pictures: dict[int, PictureStamps] = {}
        self._reports: deque[tuple[int, ...]] = deque(maxlen=window)

    def on_state(self, state: State) -> None:
        """Keeps the way of the command that this tick used; a held arm or an unstamped command has none."""
        for arm in state.arms:
            if arm.arm == self._arm and arm.fresh and arm.stamps.input_sent_ns:
                stamps = (
                    arm.stamps.input_sent_ns,
                    arm.stamps.gateway_received_ns,
                    arm.arrived_ns,
                    state.stamps.fired_ns,
                    state.stamps.stepped_ns,
                )
                _keep(self._until_state, state.tick, stamps, self._ticks)

    def on_picture(self, tick: int, stamps: PictureStamps) -> None:
        """A picture sent a second time closes the account: a report from now on may mean either."""
        if tick in self._pictures:
            self._until_state.pop(tick, None)
        _keep(self._pictures, tick, stamps, self._ticks)

    def on_seen(self, tick: int, displayed_ns: int) -> bool:
        """A page displayed this tick; False where the account cannot be closed or cannot be true."""
        until_state, picture = self._until_state.get(tick), self._pictures.get(tick)
        if until_state is None or picture is None:
            return False
        if not picture.encoded_ns <= displayed_ns < until_state[0] + _LONGEST_NS:
            return False
        del self._until_state[tick]  # one report for each tick
        self.reports += 1
        self._reports.append(
            (*until_state, picture.state_received_ns, picture.rendered_ns, picture.encoded_ns, displayed_ns)
        )
        return True

    def summary(self) -> Summary | None:
        """None before the first report."""
        if not self._reports:
            return None
        stamps = np.array(self._reports, dtype=np.int64)
        total_ms = (stamps[:, -1] - stamps[:, 0]) * _MS_PER_NS
        stages_ms = np.median(np.diff(stamps, axis=1), axis=0) * _MS_PER_NS
        p50_ms, p95_ms = np.percentile(total_ms, (50, 95))
        return Summary(float(p50_ms), float(p95_ms), len(stamps), tuple(stages_ms.tolist()))


def _keep(kept: dict[int, T], tick: int, value: T, at_most: int) -> None:
    kept[tick] = value
    while len(kept) > at_most:
        del kept[next(iter(kept))]
