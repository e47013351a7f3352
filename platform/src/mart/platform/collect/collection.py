"""Episodes with nobody there: `mart demo` and `mart collect`, every part real."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from mart.platform.collect.browser import running_browser
from mart.platform.collect.emulated_users import EmulatedUsers
from mart.platform.collect.live_session import LiveSession
from mart.platform.collect.operators import SeatOperators
from mart.platform.collect.saved_episodes import CollectedEpisode, SavedEpisodes
from mart.platform.collect.unpaced_session import UnpacedSession
from mart.platform.run.plan import (
    PlatformOptions,
    lockstep_processes,
)
from mart.platform.run.running import running_platform
from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import get_task
from mart.runtime.ports import free_port


@dataclass(frozen=True)
class CollectionSpec:
    """What to collect. `browsers` opens a real operator page per person, which also measures motion to photon.

    time_limit_s: of an episode, simulated; None: the task's trial. arm_kinds: by arm, of those that are no Pandas.
    """

    task: str
    episodes: int
    skill: str
    seed: int
    control_hz: float
    out: Path
    operators: SeatOperators
    time_limit_s: float | None = None
    browsers: bool = False
    arm_kinds: Mapping[str, str] = field(default_factory=dict)


def collect_episodes(spec: CollectionSpec) -> Iterator[CollectedEpisode]:
    """Runs a platform of its own, seats the operators, and yields each episode when its file is saved."""
    with contextlib.ExitStack() as stack:
        platform = stack.enter_context(running_platform(_private_options(spec)))
        browser = stack.enter_context(running_browser()) if spec.browsers else None
        users = EmulatedUsers(platform, spec.skill, spec.seed, browser)
        people = stack.enter_context(users.seated(spec.operators.scripts))
        stack.enter_context(users.beside(spec.operators.policies))
        session = LiveSession(platform.bus, platform.options.room, SavedEpisodes(spec.out).find)
        stack.enter_context(contextlib.closing(session))
        for _ in range(spec.episodes):
            yield session.run_episode(people)


def collect_in_lockstep(spec: CollectionSpec) -> Iterator[CollectedEpisode]:
    """The same people without phones, video and clocks: one room per core, as fast as the machine allows.

    Raises InvalidInput where a policy is among them.
    """
    if spec.operators.policies:
        raise InvalidInput(
            "A policy was given with --lockstep, where only scripts drive: leave one of them out."
        )
    options = _private_options(spec)
    plan = lockstep_processes(options, rooms=min(os.cpu_count() or 1, spec.episodes))
    rooms = [process.id for process in plan if process.kind == "sim"]
    with (
        running_platform(options, plan) as platform,
        contextlib.closing(
            UnpacedSession(platform.bus, rooms, spec.episodes, SavedEpisodes(spec.out).find)
        ) as session,
    ):
        yield from session.run()


def _private_options(spec: CollectionSpec) -> PlatformOptions:
    """On free ports and with rooms of its own, beside any other platform that runs here, also in the same folder."""
    return PlatformOptions(
        data_dir=spec.out,
        name="collect",
        room="collect-1",
        router=f"tcp/127.0.0.1:{free_port()}",
        port=free_port(),
        task=spec.task,
        seed=spec.seed,
        skill=spec.skill,
        time_limit_s=get_task(spec.task).trial_limit_s if spec.time_limit_s is None else spec.time_limit_s,
        control_hz=spec.control_hz,
        arm_kinds=spec.arm_kinds,
    )
