"""On a clean engine: up, a session, down, up again, and everything is still there. Run by `make test-compose`."""

from __future__ import annotations

import contextlib
import functools
import json
import os
from collections.abc import Iterator
from pathlib import Path
from unittest import mock

import pytest

from mart.platform.collect.browser import running_browser
from mart.platform.collect.emulated_users import EmulatedUsers
from mart.platform.collect.live_session import LiveSession
from mart.platform.collect.saved_episodes import CollectedEpisode
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.running import Platform
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import EpisodeOutcome, Verdict
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.compose.stack import Stack, join_code_in
from tests.contract.repository import ROOT

pytestmark = pytest.mark.timeout(1200)  # the first build installs everything six times


@pytest.fixture(scope="module")
def stack(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stack]:
    stack = Stack("mart-test", free_port(), tmp_path_factory.mktemp("compose"))
    stack.forget()
    stack.up()
    yield stack
    log = ROOT / "test-output" / "compose.log"
    log.parent.mkdir(exist_ok=True)
    log.write_text(stack.logs())
    stack.forget()


@contextlib.contextmanager
def visited(stack: Stack) -> Iterator[Platform]:
    options = PlatformOptions(
        data_dir=stack.folder, router=f"tcp/{stack.address('router')}:7447", port=stack.port, seed=1
    )
    secret = {"MART_BUS_SECRET_FILE": str(stack.bus_secret)}
    with (
        mock.patch.dict(os.environ, secret),
        ZenohBus.connect(options.router, wait_for_router=False) as bus,
    ):
        platform = Platform(options, bus)
        platform.logs_dir.mkdir(exist_ok=True)
        yield platform


def episodes(stack: Stack) -> list[dict[str, object]]:
    listed: list[dict[str, object]] = json.loads(
        stack.inside("recorder", "mart", "episodes", "list", "--json")
    )["episodes"]
    return listed


def saved_episode(stack: Stack, room: str, number: int) -> CollectedEpisode | None:
    for row in episodes(stack):
        if (row["room"], row["number"]) == (room, number):
            return CollectedEpisode(
                number=number,
                seed=None,
                skill="",
                path=str(row["path"]),
                outcome=EpisodeOutcome(str(row["outcome"])),
                reason="",
                ticks=0,
                simulated_s=0.0,
                real_time_factor=None,
                verdict=Verdict.VERIFIED if row["verified"] else Verdict.UNVERIFIED,
            )
    return None


def test_no_part_runs_as_root_or_can_write_to_its_own_code(stack: Stack) -> None:
    for service in stack.services():
        assert stack.inside(service, "id", "-u").strip() != "0"
        assert (
            stack.inside(service, "sh", "-c", "touch /opt/mart/probe 2>/dev/null || echo refused")
            == "refused\n"
        )


def test_people_collect_a_verified_episode_and_the_next_start_finds_it(stack: Stack) -> None:
    arms = [arm.name for arm in get_task("two_arm_multi_cube_lifting").arms]
    with visited(stack) as platform, running_browser() as browser, contextlib.ExitStack() as session_ends:
        people = session_ends.enter_context(
            EmulatedUsers(platform, "expert", seed=1, browser=browser).seated(arms)
        )
        session = session_ends.enter_context(
            contextlib.closing(
                LiveSession(platform.bus, platform.options.room, functools.partial(saved_episode, stack))
            )
        )
        episode = session.run_episode(people)
    assert (episode.outcome, episode.verified) == ("success", True), episode.verdict
    assert [latency.arm for latency in episode.latencies] == arms
    before = episodes(stack)
    assert [Path(str(entry["path"])).name for entry in before] == [Path(episode.path).name]

    code = (stack.folder / "join-code").read_text()
    certificate = (stack.folder / "certificates/site.crt").read_text()
    stack.down()
    printed = stack.up()
    assert join_code_in(printed) == code.strip()
    assert (stack.folder / "certificates/site.crt").read_text() == certificate
    assert episodes(stack) == before


def test_a_job_learns_from_what_was_collected_and_is_judged(stack: Stack) -> None:
    submitted = stack.inside(
        "trainer",
        *("mart", "jobs", "submit", "--tasks", "two_arm_multi_cube_lifting", "--models", "BC-RNN"),
        *("--preset", "debug", "--episodes", "2", "--score-episodes", "0", "--json"),
    )
    (queued,) = json.loads(submitted)["jobs"]
    (job,) = json.loads(stack.inside("trainer", "mart", "jobs", "wait", queued["sweep"], "--json"))["jobs"]
    assert job["state"] == "JOB_STATE_DONE"


def test_killed_parts_come_back(stack: Stack) -> None:
    for service in ("sim", "gateway", "recorder", "web"):
        stack.kill(service)
    assert "Lobby" in stack.up()
