"""Episodes with nobody there: `mart demo` and `mart collect`, every part real."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mart.platform.browser import running_browser
from mart.platform.crew import Crew
from mart.platform.plan import Options
from mart.platform.ports import free_port
from mart.platform.session import Episode, Session
from mart.platform.supervise import running_platform
from mart.protocol.tasks import get_task


@dataclass(frozen=True)
class Order:
    """What to collect. `browsers` opens a real operator page per person, which also measures motion to photon."""

    task: str
    episodes: int
    skill: str
    seed: int
    control_hz: float
    out: Path
    browsers: bool


def collect_episodes(order: Order) -> Iterator[Episode]:
    """Runs a platform of its own, seats one emulated person per arm, and yields each episode when its file is saved."""
    arms = tuple(arm.name for arm in get_task(order.task).arms)
    with contextlib.ExitStack() as stack:
        platform = stack.enter_context(running_platform(_private_options(order)))
        browser = stack.enter_context(running_browser()) if order.browsers else None
        crew = Crew(platform, order.skill, order.seed, browser)
        people = stack.enter_context(crew.seated(arms))
        session = stack.enter_context(contextlib.closing(Session(platform.bus, platform.options.room)))
        for _ in range(order.episodes):
            yield session.run_episode(people)


def _private_options(order: Order) -> Options:
    """On free ports, beside any other platform that runs here."""
    return Options(
        data_dir=order.out,
        router=f"tcp/127.0.0.1:{free_port()}",
        port=free_port(),
        task=order.task,
        seed=order.seed,
        control_hz=order.control_hz,
    )
