"""Thirty minutes of three operators who come back again and again, and two spectators: nothing grows.

Each operator is an emulated phone and a page in Chromium; every minute another page is loaded anew. Two more peers
watch, one by video and one by poses. Once a minute memory, threads and open files (sockets among them) of every service
are looked at, and what people's pages say of the delay. What counts is the last third of the time beside the second: in
the first, services fill what they keep.

    python benchmarks/endurance.py [MINUTES]
"""

from __future__ import annotations

import contextlib
import queue
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean, median

from report import Bar, report
from support.service_processes import Held, held_by_services
from support.watchers import watching

from mart.platform.collect.browser import running_browser
from mart.platform.collect.emulated_users import EmulatedUsers
from mart.platform.collect.web_client import WebClient
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.running import Platform, running_platform
from mart.protocol import keys
from mart.protocol.codec import decode
from mart.protocol.messages import Event
from mart.runtime.ports import free_port

TASK, ARMS = "three_arm_lift_wiping", ("arm0", "arm1", "arm2")
MINUTES = 30
MINUTE_S = 60.0


@dataclass(frozen=True)
class Minute:
    """What the services held at its end, by kind, and the median of what pages told of motion to photon in it."""

    held: dict[str, Held]
    delay_ms: float


def watch_for(minutes: int) -> list[Minute]:
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        options = PlatformOptions(
            data_dir=Path(folder),
            router=f"tcp/127.0.0.1:{free_port()}",
            port=free_port(),
            task=TASK,
            control_hz=20.0,
            seed=0,
        )
        platform = stack.enter_context(running_platform(options))
        browser = stack.enter_context(running_browser())
        stack.enter_context(EmulatedUsers(platform, "expert", 0, browser).seated(ARMS))
        for draws in (False, True):
            eve = WebClient(platform.url, platform.certificate)
            stack.enter_context(contextlib.closing(eve))
            eve.join(platform.join_code, "Eve")
            stack.enter_context(watching([eve], options.room, ARMS[0], draws=draws))
        pages = [context.pages[0] for context in browser.contexts]
        delays = stack.enter_context(_delays(platform))
        watched = []
        for minute in range(minutes):
            pages[minute % len(pages)].reload()
            time.sleep(MINUTE_S)
            told = [delays.get() for _ in range(delays.qsize())]
            watched.append(Minute(held_by_services(), median(told) if told else float("nan")))
            print(minute + 1, watched[-1], flush=True)
        return watched


@contextlib.contextmanager
def _delays(platform: Platform) -> Iterator[queue.Queue[float]]:
    inbox: queue.Queue[float] = queue.Queue()

    def on_event(event: Event) -> None:
        if event.HasField("latency"):
            inbox.put(event.latency.p50_ms)

    key = keys.event(platform.options.room).key
    with contextlib.closing(platform.bus.subscribe(key, lambda told: on_event(decode(Event, told.payload)))):
        yield inbox


def grown(minutes: Sequence[Minute], kind: str, what: str) -> float:
    """Return how much more of something services of a kind held in the last third than in the second."""
    third = len(minutes) // 3
    values = [getattr(minute.held[kind], what) for minute in minutes]
    return mean(values[-third:]) - mean(values[third : 2 * third])


def main() -> None:
    minutes = watch_for(int(sys.argv[1]) if len(sys.argv) > 1 else MINUTES)
    third = len(minutes) // 3
    kinds = sorted(minutes[-1].held)
    metrics: dict[str, float] = {"minutes": len(minutes)}
    for kind in kinds:
        for what in ("memory_mb", "threads", "files"):
            metrics[f"{kind}_{what}"] = getattr(minutes[-1].held[kind], what)
            metrics[f"{kind}_{what}_grown"] = grown(minutes, kind, what)
    second, last = (
        median(m.delay_ms for m in part) for part in (minutes[third : 2 * third], minutes[-third:])
    )
    metrics["delay_p50_ms"], metrics["delay_grown_ms"] = last, last - second
    bars = [Bar.at_most("delay of the last third, of the second's", last / second, 1.25)]
    for kind in kinds:
        memory, threads, files = (
            metrics[f"{kind}_{what}_grown"] for what in ("memory_mb", "threads", "files")
        )
        bars.append(Bar.at_most(f"{kind}: memory grown, MB", memory, 5.0))
        bars.append(Bar.at_most(f"{kind}: threads grown", threads, 1.0))
        bars.append(Bar.at_most(f"{kind}: open files grown", files, 2.0))
    report("endurance", metrics, {}, bars)


if __name__ == "__main__":
    main()
