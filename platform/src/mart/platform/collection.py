"""Episodes with nobody there: `mart demo` and `mart collect`, every part real."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mart.platform.browser import running_browser
from mart.platform.crew import Crew
from mart.platform.lockstep import LockstepSession
from mart.platform.operators import Operators
from mart.platform.plan import Options, lockstep_processes
from mart.platform.session import Episode, Session
from mart.platform.supervise import running_platform
from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import get_task
from mart.runtime.ports import free_port


@dataclass(frozen=True)
class Order:
    """What to collect. `browsers` opens a real operator page per person, which also measures motion to photon.

    time_limit_s: of an episode, simulated; None: the task's trial.
    """

    task: str
    episodes: int
    skill: str
    seed: int
    control_hz: float
    out: Path
    operators: Operators
    time_limit_s: float | None = None
    browsers: bool = False


def collect_episodes(order: Order) -> Iterator[Episode]:
    """Runs a platform of its own, seats the operators, and yields each episode when its file is saved."""
    with contextlib.ExitStack() as stack:
        platform = stack.enter_context(running_platform(_private_options(order)))
        browser = stack.enter_context(running_browser()) if order.browsers else None
        crew = Crew(platform, order.skill, order.seed, browser)
        people = stack.enter_context(crew.seated(order.operators.scripts))
        stack.enter_context(crew.beside(order.operators.policies))
        session = stack.enter_context(contextlib.closing(Session(platform.bus, platform.options.room)))
        for _ in range(order.episodes):
            yield session.run_episode(people)


def collect_in_lockstep(order: Order) -> Iterator[Episode]:
    """The same people without phones, video and clocks: one room per core, as fast as the machine allows.

    Raises InvalidInput where a policy is among them.
    """
    if order.operators.policies:
        raise InvalidInput(
            "A policy was given with --lockstep, where only scripts drive: leave one of them out."
        )
    options = _private_options(order)
    plan = lockstep_processes(options, rooms=min(os.cpu_count() or 1, order.episodes))
    rooms = [process.id for process in plan if process.kind == "sim"]
    with (
        running_platform(options, plan) as platform,
        contextlib.closing(LockstepSession(platform.bus, rooms, order.episodes)) as session,
    ):
        yield from session.run()


def _private_options(order: Order) -> Options:
    """On free ports, beside any other platform that runs here."""
    return Options(
        data_dir=order.out,
        router=f"tcp/127.0.0.1:{free_port()}",
        port=free_port(),
        task=order.task,
        seed=order.seed,
        skill=order.skill,
        time_limit_s=get_task(order.task).trial_limit_s if order.time_limit_s is None else order.time_limit_s,
        control_hz=order.control_hz,
    )
