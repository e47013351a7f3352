"""A person and a policy in one scene, live: takeover in mid-episode, hand-back, and a file that says who drove when."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from mart.platform.collect.emulated_users import EmulatedUsers
from mart.platform.collect.web_client import WebClient
from mart.platform.run.plan import (
    PlatformOptions,
    Process,
    processes,
)
from mart.platform.run.running import (
    Platform,
    running_platform,
)
from mart.protocol import clock, keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import (
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    ArmState,
    Event,
    Operator,
    State,
)
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.ports import free_port
from mart.sim.world import World
from mart.trainer.jobs.service.promotion import Origin, promote
from mart.trainer.train.run_directory import RunDirectory
from mart.trainer.train.spec import TrainingSpec
from mart.trainer.train.training import train
from tests.support.message_collector import MessageCollector
from tests.support.processes import started
from tests.trainer import recorded

ROOM, MINE, OTHER = "room-1", "arm0", "arm1"
TASK = recorded.TASK
WAIT_S = 40.0
LIMIT_M = get_task(TASK).arms[0].kind.limits.step_m


@pytest.fixture(scope="module")
def checkpoint(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of a per-arm model that has hardly learned anything: what is tested is the way, not the skill."""
    root = tmp_path_factory.mktemp("training")
    world = World.build(TASK)
    recorded.write(root / "episodes", world, recorded.perform(world, seed=1))
    request = TrainingSpec(
        model="d-HBC", data=(root / "episodes",), preset="debug", changes={"updates": 3, "checkpoints": 1}
    )
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setenv("MART_DATA_DIR", str(root))
        train(request, root / "run", threading.Event(), lambda _: None)
    run = RunDirectory(root / "run")
    return run.checkpoint(run.checkpointed()[-1], 0)


@pytest.fixture(scope="module")
def platform(checkpoint: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Platform]:
    data_dir = tmp_path_factory.mktemp("platform")
    promote(data_dir / "policies", "lifter", checkpoint, Origin(job="", evaluation=None), clock.wall_ns())
    options = PlatformOptions(data_dir, router=f"tcp/127.0.0.1:{free_port()}", port=free_port(), seed=3)
    policies = Process(("policies",), ServiceKind.POLICIES, "policies")
    with running_platform(options, (*processes(options), policies)) as running:
        yield running


@pytest.fixture
def states(platform: Platform) -> Iterator[MessageCollector[State]]:
    with MessageCollector(platform.bus, keys.state(ROOM).key, State) as states:
        yield states


@pytest.fixture
def events(platform: Platform) -> Iterator[MessageCollector[Event]]:
    with MessageCollector(platform.bus, keys.event(ROOM).key, Event) as events:
        yield events


def driven_by(state: State, arm: str, source: Operator) -> bool:
    return any(one.arm == arm and one.fresh and one.source == source for one in state.arms)


def await_ticks(
    states: MessageCollector[State], arm: str, source: Operator, ticks: int, episode: bool = True
) -> None:
    """So many more ticks in which `source` drives the arm."""
    for _ in range(ticks):
        states.wait_for(
            lambda state: driven_by(state, arm, source) and bool(state.episode) == episode,
            WAIT_S,
            since=len(states),
        )


@pytest.mark.timeout(150)
def test_a_person_takes_over_from_a_policy_in_mid_episode_and_hands_back(
    platform: Platform, states: MessageCollector[State], events: MessageCollector[Event]
) -> None:
    users = EmulatedUsers(platform, skill="expert", seed=0)
    with users.seated((MINE,)) as (ana,):
        ana.web_client.assign(ROOM, OTHER, "policy", "lifter")
        await_ticks(states, OTHER, OPERATOR_POLICY, 3, episode=False)
        ana.web_client.act(ROOM, MINE, "ready")
        await_ticks(states, OTHER, OPERATOR_POLICY, 15)
        with users.seated((OTHER,)) as (ben,):  # taking the seat is the takeover
            await_ticks(states, OTHER, OPERATOR_HUMAN, 15)
            ben.web_client.hand_back(ROOM, OTHER)
            await_ticks(states, OTHER, OPERATOR_POLICY, 10)
            ben.web_client.take(ROOM, OTHER)  # the phone that was paired before drives again
            await_ticks(states, OTHER, OPERATOR_HUMAN, 10)
            ben.web_client.hand_back(ROOM, OTHER)
        await_ticks(states, OTHER, OPERATOR_POLICY, 5)
        ana.web_client.act(ROOM, MINE, "failure")
        saved = events.wait_for(lambda event: event.HasField("episode_saved"), WAIT_S).episode_saved
        ana.web_client.assign(ROOM, OTHER, "hold")
    assert saved.verified, saved.verdict
    assert_file_tells_who_drove(platform.options.data_dir / saved.path)


@pytest.mark.timeout(150)
def test_a_checkpoint_is_seated_beside_a_crew_and_leaves_with_it(
    platform: Platform, checkpoint: Path, states: MessageCollector[State]
) -> None:
    with EmulatedUsers(platform, skill="expert", seed=0).beside({checkpoint: (OTHER,)}):
        await_ticks(states, OTHER, OPERATOR_POLICY, 3, episode=False)
    states.wait_for(lambda state: not driven_by(state, OTHER, OPERATOR_POLICY), WAIT_S, since=len(states))


@pytest.mark.timeout(150)
def test_a_checkpoint_that_cannot_be_seated_says_why(platform: Platform, tmp_path: Path) -> None:
    (tmp_path / "checkpoint.json").write_text("{}")
    users = EmulatedUsers(platform, skill="expert", seed=0)
    with pytest.raises(Unavailable, match=r"does not drive arm1: mart: "), users.beside({tmp_path: (OTHER,)}):
        pass


def assert_file_tells_who_drove(path: Path) -> None:
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        recorded_states = [message for *_, message in reader.iter_decoded_messages(["/state"])]
    others = [next(arm for arm in state.arms if arm.arm == OTHER) for state in recorded_states]
    sources = [arm.source for arm in others[1:]]
    changes = [tick for tick in range(1, len(sources)) if sources[tick] != sources[tick - 1]]
    assert [sources[tick] for tick in (0, *changes)] == [
        OPERATOR_POLICY,
        *2 * (OPERATOR_HUMAN, OPERATOR_POLICY),
    ]
    assert [state.episode_tick for state in recorded_states] == list(range(len(recorded_states)))
    told = metadata["mart.operators"]
    drivers = [driver.split(": ")[-1] for driver in told[OTHER].split(" | ")]
    assert drivers[0] == "policy lifter"
    assert drivers[1:] == [drivers[1], "policy lifter"] * 2
    assert drivers[1].startswith("human ")
    assert [int(one.split(":")[0].removeprefix("tick ")) for one in told[OTHER].split(" | ")[1:]] == [
        tick + 1 for tick in changes
    ]
    assert told[MINE].startswith("human Ana")
    assert_nothing_jumps(others, changes[0])


def assert_nothing_jumps(arms: list[ArmState], first: int) -> None:
    """The tool never goes further in a tick than it may, and the first commands of a person hold it where it is."""
    at = np.array([(arm.tool_in_base.x, arm.tool_in_base.y, arm.tool_in_base.z) for arm in arms])
    steps_m = np.linalg.norm(np.diff(at, axis=0), axis=1)
    assert steps_m.max() <= LIMIT_M
    taken = arms[first + 1]
    assert np.linalg.norm(taken.action[:6]) < 0.2
    assert taken.action[6] == pytest.approx(arms[first].action[6], abs=1e-6)


@pytest.mark.timeout(120)
def test_a_policy_of_ones_own_waits_while_a_person_drives_and_leaves_when_it_is_stopped(
    platform: Platform, checkpoint: Path, states: MessageCollector[State], events: MessageCollector[Event]
) -> None:
    router = platform.options.router
    command = ["operate", "--room", ROOM, "--arm", OTHER, "--checkpoint", str(checkpoint), "--name", "own"]
    with contextlib.ExitStack() as stack:
        operate = stack.enter_context(started(command, router, platform.options.data_dir))
        await_ticks(states, OTHER, OPERATOR_POLICY, 5, episode=False)
        with EmulatedUsers(platform, skill="expert", seed=0).seated((OTHER,)) as (ben,):
            await_ticks(states, OTHER, OPERATOR_HUMAN, 3, episode=False)
            ben.web_client.hand_back(ROOM, OTHER)
        await_ticks(states, OTHER, OPERATOR_POLICY, 5, episode=False)
        since = len(events)
        assert operate.terminate() == 0
        left = events.wait_for(lambda event: event.HasField("seat_changed"), WAIT_S, since=since)
        assert (left.seat_changed.arm, left.seat_changed.name) == (OTHER, "")


def test_a_policy_that_does_not_fit_is_told_and_its_seat_is_left(
    platform: Platform, events: MessageCollector[Event]
) -> None:
    with contextlib.closing(WebClient(platform.url, platform.certificate)) as ana:
        ana.join(platform.join_code, "Ana")
        ana.assign(ROOM, OTHER, "policy", "nobody-knows")
        notice = events.wait_for(lambda event: event.HasField("notice"), WAIT_S).notice
        assert "nobody-knows" in notice.text
        events.wait_for(
            lambda event: event.HasField("seat_changed") and event.seat_changed.operator == OPERATOR_HOLD,
            WAIT_S,
        )
