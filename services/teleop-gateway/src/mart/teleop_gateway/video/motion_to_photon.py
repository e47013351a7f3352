"""Measure motion to photon: from when a hand's frame was sent to when its effect was on the screen.

Every frame counts, also those that a newer one overtook before the tick: a hand moves all the time, and what it did
right after a tick waits longest. (Used commands alone would leave two thirds of a tick out of the account.) Frames that
waited while the world stood still on purpose, in a countdown or after an episode, do not count.

Pure. Every stamp is Unix time in nanoseconds on this machine's clock; the peers' own stamps have been mapped by their
clock offsets. A tick's stamps are collected on the way; a page's report of the displayed tick closes the account.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from mart.protocol.messages import Command, Event, State

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
REPORT_EVERY_S = 1.0


@dataclass(frozen=True)
class PictureStamps:
    """Hold one tick's way through the gateway."""

    state_received_ns: int
    rendered_ns: int
    encoded_ns: int


@dataclass(frozen=True)
class PageDraws:
    """Hold what the holder's page last said of its drawing; 0 where it did not measure."""

    on: bool = False
    p50_ms: float = 0.0
    p95_ms: float = 0.0
    per_s: float = 0.0


@dataclass(frozen=True)
class LatencySummary:
    """Sum up the newest reports: `frames` pictures, and the median milliseconds of each of STAGES, in order."""

    p50_ms: float
    p95_ms: float
    frames: int
    stages: tuple[float, ...]

    def __str__(self) -> str:
        stages = ", ".join(f"{name} {ms:.1f}" for name, ms in zip(STAGES, self.stages, strict=True))
        return f"p50 {self.p50_ms:.1f} ms, p95 {self.p95_ms:.1f} ms of {self.frames} pictures ({stages})"

    def event(self, arm: str, draws: PageDraws) -> Event.Latency:
        """Return the summary as the room is told of it, with what the page says of its drawing."""
        named = [Event.Latency.Stage(name=n, p50_ms=ms) for n, ms in zip(STAGES, self.stages, strict=True)]
        return Event.Latency(
            arm=arm,
            p50_ms=self.p50_ms,
            p95_ms=self.p95_ms,
            frames=self.frames,
            stages=named,
            drawn_in_page=draws.on,
            draw_p50_ms=draws.p50_ms,
            draw_p95_ms=draws.p95_ms,
            draws_per_s=draws.per_s,
        )


class MotionToPhoton:
    """Measure one arm: keeps the last `window` reports."""

    def __init__(self, arm: str, window: int = 100, ticks: int = 256, commands: int = 256) -> None:
        self.reports = 0  # in all
        self.arm = arm
        self.draws = PageDraws()
        self._ticks, self._commands = ticks, commands
        self._sent: dict[int, tuple[int, int]] = {}  # by sequence: input sent, gateway received
        self._until_state: dict[int, list[tuple[int, ...]]] = {}  # a row for each command of the tick
        self._pictures: dict[int, PictureStamps] = {}
        self._reports: deque[list[tuple[int, ...]]] = deque(maxlen=window)

    def on_command(self, command: Command) -> None:
        """Take a frame that became a command; without a stamp (its sender's clock is unknown yet) it does not count."""
        stamps = command.stamps
        if stamps.input_sent_ns:
            sent = (stamps.input_sent_ns, stamps.gateway_received_ns)
            _keep(self._sent, command.sequence, sent, self._commands)

    def on_state(self, state: State, control_hz: float) -> None:
        """Keep the way of the command that this tick used, and of those it overtook; a held arm has none."""
        # When the tick before this one could have fired.
        since_ns = state.stamps.due_ns - round(1e9 / control_hz)
        for arm in state.arms:
            if arm.arm == self.arm and arm.fresh and arm.sequence in self._sent:
                # The overtaken are taken to have reached the sim as fast as the one whose arrival is known.
                newest_ns = self._sent[arm.sequence][1]
                transit_ns = arm.arrived_ns - newest_ns
                rows: list[tuple[int, ...]] = [
                    (sent, received, received + transit_ns, state.stamps.fired_ns, state.stamps.stepped_ns)
                    for sent, received in self._take_until(arm.sequence)
                    if received >= since_ns or received == newest_ns
                ]
                _keep(self._until_state, state.tick, rows, self._ticks)

    def on_picture(self, tick: int, stamps: PictureStamps) -> None:
        """Take when a picture was made; one sent again closes the account, since a report may mean either."""
        if tick in self._pictures:
            self._until_state.pop(tick, None)
        _keep(self._pictures, tick, stamps, self._ticks)

    def on_seen(self, tick: int, displayed_ns: int) -> bool:
        """Take that a page displayed this tick; False where the account cannot be closed or cannot be true."""
        until_state, picture = self._until_state.get(tick), self._pictures.get(tick)
        if until_state is None or picture is None:
            return False
        if not picture.encoded_ns <= displayed_ns < until_state[-1][0] + _LONGEST_NS:
            return False
        del self._until_state[tick]  # one report for each tick
        self.reports += 1
        after = (picture.state_received_ns, picture.rendered_ns, picture.encoded_ns, displayed_ns)
        self._reports.append([(*row, *after) for row in until_state])
        return True

    def summary(self) -> LatencySummary | None:
        """Return the newest reports summed up; None before the first."""
        if not self._reports:
            return None
        stamps = np.array([row for rows in self._reports for row in rows], dtype=np.int64)
        total_ms = (stamps[:, -1] - stamps[:, 0]) * _MS_PER_NS
        stages_ms = np.median(np.diff(stamps, axis=1), axis=0) * _MS_PER_NS
        p50_ms, p95_ms = np.percentile(total_ms, (50, 95))
        return LatencySummary(float(p50_ms), float(p95_ms), len(self._reports), tuple(stages_ms.tolist()))

    def _take_until(self, sequence: int) -> list[tuple[int, int]]:
        return [self._sent.pop(number) for number in list(self._sent) if number <= sequence]


async def report_latency(latency: MotionToPhoton, tell: Callable[[Event.Latency], None]) -> None:
    """Tell once a second, while pages report, what was measured; until cancelled."""
    reported = 0
    while True:
        await asyncio.sleep(REPORT_EVERY_S)
        summary = latency.summary()
        if summary is not None and latency.reports > reported:
            reported = latency.reports
            tell(summary.event(latency.arm, latency.draws))


def _keep(kept: dict[int, T], number: int, value: T, at_most: int) -> None:
    kept[number] = value
    while len(kept) > at_most:
        del kept[next(iter(kept))]
