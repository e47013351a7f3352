"""Motion to photon in Chromium: emulated phones drive, real pages read the tick out of what they display.

Everything shares this machine: the browsers, the renderers, the encoders and the sim. The floor beside each figure is
what no software can remove at that tick rate: what a steadily moving hand does waits half a tick on average and a whole
one at worst, and the same for the 60 Hz screen.
"""

from __future__ import annotations

import contextlib
import queue
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from report import Bar, report

from mart.platform.collect.browser import running_browser
from mart.platform.collect.emulated_users import EmulatedUsers
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.running import (
    Platform,
    running_platform,
)
from mart.protocol import keys
from mart.protocol.codec import decode
from mart.protocol.messages import Event
from mart.runtime.bus.base import Sample
from mart.runtime.ports import free_port

REPORTS = 35  # one a second; the newest is of the last 100 pictures, 20 s, so that the start is left out
SCREEN_HZ = 60.0


@dataclass(frozen=True)
class Case:
    """`bar_ms`: motion to photon at p50 and p95."""

    name: str
    people: Sequence[str]
    control_hz: float
    bar_ms: tuple[float, float]

    @property
    def floor_ms(self) -> tuple[float, float]:
        tick_ms, screen_ms = 1000 / self.control_hz, 1000 / SCREEN_HZ
        return (tick_ms + screen_ms) / 2, tick_ms + screen_ms


CASES = (
    Case("1_person_20hz", ("arm0",), 20.0, (45.0, 70.0)),
    Case("2_people_20hz", ("arm0", "arm1"), 20.0, (60.0, 90.0)),
    Case("1_person_60hz", ("arm0",), 60.0, (30.0, 45.0)),
)


def measure(case: Case) -> list[Event.Latency]:
    """The newest report of each person, after `REPORTS` of them."""
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        options = PlatformOptions(
            data_dir=Path(folder),
            router=f"tcp/127.0.0.1:{free_port()}",
            port=free_port(),
            control_hz=case.control_hz,
            seed=0,
        )
        platform = stack.enter_context(running_platform(options))
        browser = stack.enter_context(running_browser())
        stack.enter_context(EmulatedUsers(platform, "expert", 0, browser).seated(case.people))
        return _newest_reports(platform, case.people)


def _newest_reports(platform: Platform, people: Sequence[str]) -> list[Event.Latency]:
    heard: queue.Queue[Event] = queue.Queue()

    def on_event(sample: Sample) -> None:
        heard.put(decode(Event, sample.payload))

    newest: dict[str, Event.Latency] = {}
    counts = dict.fromkeys(people, 0)
    with contextlib.closing(platform.bus.subscribe(keys.event(platform.options.room).key, on_event)):
        while min(counts.values()) < REPORTS:
            event = heard.get(timeout=30.0)
            if event.HasField("latency"):
                newest[event.latency.arm] = event.latency
                counts[event.latency.arm] += 1
    return [newest[arm] for arm in people]


def main() -> None:
    metrics: dict[str, float | str] = {}
    floors: dict[str, float] = {}
    bars = []
    for case in CASES:
        worst = max(measure(case), key=lambda latency: latency.p95_ms)
        metrics[f"{case.name}_p50_ms"], metrics[f"{case.name}_p95_ms"] = worst.p50_ms, worst.p95_ms
        metrics[f"{case.name}_stages_p50_ms"] = ", ".join(f"{s.name} {s.p50_ms:.1f}" for s in worst.stages)
        floors[f"{case.name}_floor_p50_ms"], floors[f"{case.name}_floor_p95_ms"] = case.floor_ms
        bars.append(Bar.at_most(f"{case.name} p50, ms", worst.p50_ms, case.bar_ms[0]))
        bars.append(Bar.at_most(f"{case.name} p95, ms", worst.p95_ms, case.bar_ms[1]))
    report("motion_to_photon", metrics, floors, bars)


if __name__ == "__main__":
    main()
