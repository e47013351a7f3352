"""Motion to photon in Chromium: emulated phones drive, real pages read the tick out of what they display.

Everything shares this machine: the browsers, the renderers, the encoders and the sim. The floor beside each figure is
what no software can remove at that tick rate: what a steadily moving hand does waits half a tick on average and a whole
one at worst, and the same for the 60 Hz screen. Where the page draws, what counts is when it has the poses, at a peer
in its place: software would draw for longer than all the rest, and what a graphics card takes is the device's. Beside
them stands what plain aiortc takes from a drawn picture to the screen, and the gateway's peers for the same pictures.
"""

from __future__ import annotations

import contextlib
import queue
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

import numpy as np
from report import Bar, report
from support.moving_scene import PERIOD_S, moving_scene
from support.networked_video import show
from support.stock_video import show_by_stock_aiortc
from support.watchers import watching
from support.watching_page import Displayed

from mart.platform.collect.browser import running_browser
from mart.platform.collect.emulated_users import EmulatedUser, EmulatedUsers
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.running import (
    Platform,
    running_platform,
)
from mart.protocol import keys
from mart.protocol.codec import decode
from mart.protocol.messages import (
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    EpisodePhase,
    Event,
    RoomStatus,
)
from mart.protocol.tasks import get_task
from mart.runtime.ports import free_port

Inbox = queue.Queue[Event | RoomStatus]

SETTLE_S = 5.0
LONGEST_SILENCE_S = 30.0
REPORTS = 35  # one a second; the newest is of the last 100 pictures, 20 s, so that the start is left out
SCREEN_HZ = 60.0


CUBES, WIPING = "two_arm_multi_cube_lifting", "three_arm_lift_wiping"


@dataclass(frozen=True)
class Case:
    """`bar_ms`: motion to photon at p50 and p95. control_hz: None where the room finds out what the machine holds.

    page_draws: the holder's page would draw, and a peer stands in its place.
    """

    name: str
    people: int
    bar_ms: tuple[float, float]
    task: str = CUBES
    control_hz: float | None = None
    page_draws: bool = False


CASES = (
    Case("1_person", 1, (30.0, 45.0)),
    Case("2_people", 2, (40.0, 60.0)),
    Case("3_people", 3, (60.0, 90.0), task=WIPING),
    Case("1_person_page_draws_60hz", 1, (25.0, 40.0), control_hz=60.0, page_draws=True),
)


@dataclass
class Heard:
    """What a room said while people drove: reports by arm, what a tick's picture takes, and how well it kept time."""

    latencies: dict[str, Event.Latency] = field(default_factory=dict)
    reports: dict[str, int] = field(default_factory=dict)
    picture_ms: float = 0.0
    status: RoomStatus = field(default_factory=RoomStatus)
    factors: list[float] = field(default_factory=list)

    def on_event(self, event: Event) -> None:
        if event.HasField("latency"):
            arm = event.latency.arm
            self.latencies[arm] = event.latency
            self.reports[arm] = self.reports.get(arm, 0) + 1
        if event.HasField("picture_cost"):
            self.picture_ms = event.picture_cost.picture_ms

    def on_status(self, status: RoomStatus) -> None:
        self.status = status
        self.factors.append(status.real_time_factor)


def measure(case: Case) -> Heard:
    """What is heard until each person has told `REPORTS` times."""
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        options = PlatformOptions(
            data_dir=Path(folder),
            router=f"tcp/127.0.0.1:{free_port()}",
            port=free_port(),
            control_hz=case.control_hz,
            task=case.task,
            seed=0,
        )
        platform = stack.enter_context(running_platform(options))
        browser = None if case.page_draws else stack.enter_context(running_browser())
        arms = [f"arm{number}" for number in range(case.people)]
        people = stack.enter_context(EmulatedUsers(platform, "expert", 0, browser).seated(arms))
        if case.page_draws:
            stack.enter_context(watching([people[0].web_client], options.room, arms[0], draws=True))
        for arm in get_task(case.task).arms[case.people :]:
            people[0].web_client.assign(options.room, arm.name, "script")
        inbox = stack.enter_context(_listening(platform))
        if case.control_hz is None:
            _play_one(options.room, people, inbox)
        return _hear(inbox, arms)


@contextlib.contextmanager
def _listening(platform: Platform) -> Iterator[Inbox]:
    inbox: Inbox = queue.Queue()
    bus, room = platform.bus, platform.options.room
    with (
        contextlib.closing(
            bus.subscribe(keys.event(room).key, lambda told: inbox.put(decode(Event, told.payload)))
        ),
        contextlib.closing(
            bus.subscribe(keys.status(room).key, lambda told: inbox.put(decode(RoomStatus, told.payload)))
        ),
    ):
        yield inbox


def _play_one(room: str, people: Sequence[EmulatedUser], inbox: Inbox) -> None:
    """Play an episode: after one, a room knows what pictures take and may choose another rate."""
    time.sleep(SETTLE_S)
    for person in people:
        person.web_client.act(room, person.arm, "ready")
    _await(inbox, EPISODE_PHASE_RECORDING)
    _await(inbox, EPISODE_PHASE_ENDED)
    people[0].web_client.act(room, people[0].arm, "reset")
    _await(inbox, EPISODE_PHASE_PRACTICE)


def _await(inbox: Inbox, phase: EpisodePhase) -> None:
    while True:
        told = inbox.get(timeout=LONGEST_SILENCE_S)
        if isinstance(told, RoomStatus) and told.episode.phase == phase:
            return


def _hear(inbox: Inbox, arms: Sequence[str]) -> Heard:
    heard = Heard()
    while min((heard.reports.get(arm, 0) for arm in arms), default=0) < REPORTS:
        told = inbox.get(timeout=LONGEST_SILENCE_S)
        if isinstance(told, Event):
            heard.on_event(told)
        else:
            heard.on_status(told)
    return heard


def figures(case: Case, heard: Heard) -> tuple[dict[str, float | str], dict[str, float]]:
    """Return what the slowest person's reports say, and the floor of it."""
    worst = max(heard.latencies.values(), key=lambda latency: latency.p95_ms)
    tick_ms, screen_ms = 1000 / heard.status.control_hz, 1000 / SCREEN_HZ
    found: dict[str, float | str] = {
        "p50_ms": worst.p50_ms,
        "p95_ms": worst.p95_ms,
        "control_hz": heard.status.control_hz,
        "real_time_factor": median(heard.factors[-REPORTS:]),
        "picture_ms": heard.picture_ms,
        "stages_p50_ms": ", ".join(f"{stage.name} {stage.p50_ms:.1f}" for stage in worst.stages),
    }
    floor = {"floor_p50_ms": (tick_ms + screen_ms) / 2, "floor_p95_ms": tick_ms + screen_ms}
    return {f"{case.name}_{name}": value for name, value in found.items()}, {
        f"{case.name}_{name}": value for name, value in floor.items()
    }


def beside_stock_aiortc(
    frames_per_s: float, seconds: float
) -> tuple[dict[str, float | str], dict[str, float]]:
    """Return how long a drawn picture takes to the screen through the gateway's peers, and through plain aiortc."""
    pictures = list(moving_scene(frames_per_s, int(PERIOD_S * frames_per_s)))
    ours = show(pictures, frames_per_s, (), seconds, follows=True)
    stock = show_by_stock_aiortc(pictures, frames_per_s, seconds)

    def named(displayed: Displayed) -> dict[str, float]:
        per_s = 1e3 * (len(displayed.at_ms) - 1) / float(np.ptp(displayed.at_ms))
        p50_ms, p95_ms = np.percentile(displayed.delay_ms, (50, 95))
        return {
            "drawn_to_displayed_p50_ms": float(p50_ms),
            "drawn_to_displayed_p95_ms": float(p95_ms),
            "displayed_per_s": per_s,
        }

    return dict(named(ours)), {f"stock_aiortc_{name}": value for name, value in named(stock).items()}


def main() -> None:
    wanted = [case for case in CASES if not sys.argv[1:] or case.name in sys.argv[1:]]
    metrics, peer = beside_stock_aiortc(30.0, 15.0)
    bars = [
        Bar.at_most(
            "drawn to displayed p95, of stock aiortc's",
            float(metrics["drawn_to_displayed_p95_ms"]) / peer["stock_aiortc_drawn_to_displayed_p95_ms"],
            1.0,
        )
    ]
    for case in wanted:
        found, floor = figures(case, measure(case))
        metrics |= found
        peer |= floor
        for at, bar_ms in zip(("p50", "p95"), case.bar_ms, strict=True):
            bars.append(Bar.at_most(f"{case.name} {at}, ms", float(found[f"{case.name}_{at}_ms"]), bar_ms))
        if case.page_draws:
            picture_ms = float(found[f"{case.name}_picture_ms"])
            bars.append(Bar.at_most(f"{case.name}: a tick's pictures take, ms", picture_ms, 0.5))
        factor = float(found[f"{case.name}_real_time_factor"])
        bars.append(Bar.at_least(f"{case.name}: real-time factor", factor, 0.98))
    report("motion_to_photon", metrics, peer, bars)


if __name__ == "__main__":
    main()
