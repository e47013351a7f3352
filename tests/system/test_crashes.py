"""kill -9 of each part in the middle of an episode that two emulated phones drive over WebRTC.

Bars: everyone is told within a second; what was recorded up to a second before is readable; the room goes on.
"""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from mcap.exceptions import McapError
from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader

from mart.platform.collect.emulated_users import (
    EmulatedUser,
    EmulatedUsers,
)
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.running import (
    Platform,
    running_platform,
)
from mart.protocol import clock, keys
from mart.protocol.codec import decode
from mart.protocol.messages import OPERATOR_HUMAN, Event, State
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Sample
from mart.runtime.ports import free_port
from tests.support.crashing import frozen_service, kill_seat_process, kill_service

ARMS = ("arm0", "arm1")
TICKS_PER_S = 20
TOLD_WITHIN_S = 1.0
BACK_WITHIN_S = 30.0
SAVED_WITHIN_S = 90.0


class Witness:
    """Hears everything that a room says, from before the crash until long after."""

    def __init__(self, platform: Platform) -> None:
        room = platform.options.room
        self.states: queue.Queue[State] = queue.Queue()
        self.events: queue.Queue[Event] = queue.Queue()
        self._subscriptions = [
            platform.bus.subscribe(keys.state(room).key, self._on_state),
            platform.bus.subscribe(keys.event(room).key, self._on_event),
        ]

    def await_state(self, wanted: Callable[[State], bool], timeout_s: float) -> State:
        deadline_s = clock.monotonic_s() + timeout_s
        while not wanted(state := self.states.get(timeout=deadline_s - clock.monotonic_s())):
            pass
        return state

    def await_notice(self, timeout_s: float) -> Event:
        deadline_s = clock.monotonic_s() + timeout_s
        while True:
            event = self.events.get(timeout=deadline_s - clock.monotonic_s())
            if event.HasField("notice"):
                return event

    def forget(self) -> None:
        for waiting in (self.states, self.events):
            with contextlib.suppress(queue.Empty):
                while True:
                    waiting.get_nowait()

    def close(self) -> None:
        for subscription in self._subscriptions:
            subscription.close()

    def _on_state(self, sample: Sample) -> None:
        self.states.put(decode(State, sample.payload))

    def _on_event(self, sample: Sample) -> None:
        self.events.put(decode(Event, sample.payload))


@pytest.fixture(scope="module")
def platform(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Platform]:
    data_dir = tmp_path_factory.mktemp("platform")
    options = PlatformOptions(data_dir, router=f"tcp/127.0.0.1:{free_port()}", port=free_port(), seed=3)
    with running_platform(options) as running:
        yield running


@pytest.fixture(scope="module")
def people(platform: Platform) -> Iterator[list[EmulatedUser]]:
    with EmulatedUsers(platform, skill="novice", seed=0).seated(ARMS) as users:
        yield users


@pytest.fixture
def witness(platform: Platform) -> Iterator[Witness]:
    with contextlib.closing(Witness(platform)) as listening:
        yield listening


def driven_by_both(state: State) -> bool:
    return all(arm.fresh and arm.source == OPERATOR_HUMAN for arm in state.arms)


def two_seconds_into_an_episode(platform: Platform, people: list[EmulatedUser], witness: Witness) -> State:
    witness.await_state(lambda state: state.episode == 0 and driven_by_both(state), BACK_WITHIN_S)
    for person in people:
        person.web_client.act(platform.options.room, person.arm, "ready")
    state = witness.await_state(lambda state: state.episode_tick == 2 * TICKS_PER_S, BACK_WITHIN_S)
    witness.forget()
    return state


def say_failure(platform: Platform, people: list[EmulatedUser]) -> None:
    """What was to be seen has been: nobody waits until the task is done."""
    people[0].web_client.act(platform.options.room, people[0].arm, "failure")


def recorded_ticks(path: Path) -> list[int]:
    """Of an unfinished file, with the stock reader alone."""
    schemas: dict[int, str] = {}
    channels: dict[int, int] = {}
    ticks = []
    with path.open("rb") as file, contextlib.suppress(McapError):
        for record in StreamReader(file).records:
            if isinstance(record, Schema):
                schemas[record.id] = record.name
            elif isinstance(record, Channel):
                channels[record.id] = record.schema_id
            elif isinstance(record, Message) and schemas[channels[record.channel_id]] == "mart.v1.State":
                ticks.append(State.FromString(record.data).tick)
    return ticks


def newest_file(platform: Platform) -> Path:
    return max(
        (platform.options.data_dir / "episodes").rglob("*.mcap*"), key=lambda path: path.stat().st_mtime
    )


@pytest.mark.timeout(180)
def test_kill_9_of_the_recorder(platform: Platform, people: list[EmulatedUser], witness: Witness) -> None:
    before = two_seconds_into_an_episode(platform, people, witness)
    gone, back = threading.Event(), threading.Event()

    def on_token(_key: str, alive: bool) -> None:
        if not alive:
            gone.set()
        elif gone.is_set():
            back.set()

    with contextlib.closing(platform.bus.watch(keys.alive_of(ServiceKind.RECORDER), on_token)):
        kill_service(platform, "recorder")
        assert gone.wait(TOLD_WITHIN_S)
        assert recorded_ticks(newest_file(platform))[-1] >= before.tick - TICKS_PER_S
        assert back.wait(BACK_WITHIN_S)
    assert driven_by_both(witness.await_state(lambda state: state.tick > before.tick + 5, BACK_WITHIN_S))
    say_failure(platform, people)
    saved = [event_of(witness, "episode_saved") for _ in range(2)]  # the repaired part, and the rest
    assert all((platform.options.data_dir / event.episode_saved.path).exists() for event in saved)


@pytest.mark.timeout(180)
def test_a_frozen_recorder_does_not_hold_up_the_world(
    platform: Platform, people: list[EmulatedUser], witness: Witness
) -> None:
    # In practice: where an episode ends, the world stands still on purpose.
    before = witness.await_state(lambda state: state.episode == 0 and driven_by_both(state), BACK_WITHIN_S)
    with frozen_service(platform, "recorder"):
        for tick in range(before.tick, before.tick + 12 * TICKS_PER_S, TICKS_PER_S):
            witness.await_state(lambda state, tick=tick: state.tick >= tick, 2.0)  # type: ignore[misc]


@pytest.mark.timeout(180)
def test_kill_9_of_a_gateway_process(
    platform: Platform, people: list[EmulatedUser], witness: Witness
) -> None:
    before = two_seconds_into_an_episode(platform, people, witness)
    kill_seat_process(platform, "arm0")
    assert "arm0" in witness.await_notice(TOLD_WITHIN_S).notice.text
    back = witness.await_state(lambda state: state.tick > before.tick + 10, BACK_WITHIN_S)
    assert driven_by_both(back), "the same person goes on, without taking the seat anew"
    say_failure(platform, people)
    assert event_of(witness, "episode_saved").episode_saved.verified


@pytest.mark.timeout(180)
def test_kill_9_of_the_sim(platform: Platform, people: list[EmulatedUser], witness: Witness) -> None:
    before = two_seconds_into_an_episode(platform, people, witness)
    killed_s = clock.monotonic_s()
    kill_service(platform, "sim")
    while people[0].web_client.is_room_answering(platform.options.room):
        assert clock.monotonic_s() - killed_s < TOLD_WITHIN_S
    saved = event_of(witness, "episode_saved").episode_saved
    ticks = recorded_ticks(platform.options.data_dir / saved.path)
    assert ticks[-1] >= before.tick - TICKS_PER_S
    back = witness.await_state(
        lambda state: state.boot != before.boot and driven_by_both(state), BACK_WITHIN_S
    )
    assert [arm.seat_epoch for arm in back.arms] == [arm.seat_epoch for arm in before.arms]


def event_of(witness: Witness, what: str) -> Event:
    while (event := witness.events.get(timeout=SAVED_WITHIN_S)).WhichOneof("what") != what:
        pass
    return event
