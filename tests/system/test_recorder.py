"""The recorder as a process on a real bus: with a real room and its replica, and killed in the middle of an episode."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path

import av
import pytest
from av.video.codeccontext import VideoCodecContext
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.episodes.reader import EpisodeFile
from mart.protocol import clock, codec, keys, recording
from mart.protocol.errors import Conflict
from mart.protocol.messages import (
    OPERATOR_SCRIPT,
    EpisodeRequest,
    Event,
    RoomReply,
    SeatRequest,
    State,
    raise_error,
)
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus, Sample
from mart.runtime.bus.zenoh_bus import ZenohBus
from tests.recorder import synthetic
from tests.support.processes import Running, running_router, running_service, started
from tests.teleop_gateway.cameras.fake_capture import write_video

_PATIENCE_S = 60.0
_BLUE = (30, 60, 190)  # RGB
_ROOM = synthetic.ROOM
_ALIVE = keys.alive(ServiceKind.RECORDER, "recorder-1")


class Ear:
    """Hears the events of all rooms."""

    def __init__(self, bus: Bus) -> None:
        self._events: list[Event] = []
        self._heard = threading.Condition()
        self._subscription = bus.subscribe(keys.EVERY_EVENT, self._hear)

    def await_saved(self, count: int) -> list[Event.EpisodeSaved]:
        """The saved episodes, as soon as there are so many."""

        def saved() -> list[Event.EpisodeSaved]:
            return [event.episode_saved for event in self._events if event.HasField("episode_saved")]

        with self._heard:
            assert self._heard.wait_for(lambda: len(saved()) >= count, _PATIENCE_S), self._events
            return saved()

    def close(self) -> None:
        self._subscription.close()

    def _hear(self, sample: Sample) -> None:
        with self._heard:
            self._events.append(codec.decode(Event, sample.payload))
            self._heard.notify_all()


@pytest.fixture
def endpoint() -> Iterator[str]:
    with running_router() as endpoint:
        yield endpoint


@pytest.fixture
def bus(endpoint: str) -> Iterator[Bus]:
    with ZenohBus.connect(endpoint) as bus:
        yield bus


@contextmanager
def recorder(endpoint: str, data_dir: Path) -> Iterator[Running]:
    with running_service(["recorder"], endpoint, data_dir, kind="recorder", id="recorder-1") as running:
        yield running


def mart(endpoint: str, data_dir: Path, *command: str) -> dict[str, object]:
    """What a command prints as JSON."""
    with started([*command, "--json"], endpoint, data_dir) as running:
        assert running.process.wait(_PATIENCE_S) == 0, running.log()
        found: dict[str, object] = json.loads(running.log())
        return found


class ToyRoom:
    """Publishes the toy room's episode in real time, as a sim would."""

    def __init__(self, bus: Bus) -> None:
        self._states = bus.publisher(keys.state(_ROOM))
        self._events = bus.publisher(keys.event(_ROOM))
        self._commands = bus.publisher(keys.command(_ROOM, "arm0"))
        self._model = bus.serve(
            keys.model(_ROOM), lambda request: request.reply(codec.encode(synthetic.MODEL))
        )
        self._token = bus.announce(keys.alive(ServiceKind.SIM, _ROOM))

    def play(self, states: list[State], period_s: float = 0.05) -> None:
        due_s = clock.monotonic_s()
        for state in states:
            clock.sleep_s(due_s - clock.monotonic_s())
            for command in synthetic.commands_of(state):
                self._commands.put(codec.encode(command))
            self._states.put(codec.encode(state))
            due_s += period_s

    def say(self, event: Event) -> None:
        self._events.put(codec.encode(event))

    def close(self) -> None:
        self._token.close()
        self._model.close()


def pictures_of(path: Path, camera: str) -> Iterator[tuple[int, list[int]]]:
    """When each picture of a camera was captured, Unix time in nanoseconds, and the colour at its middle, RGB."""
    decoder = VideoCodecContext.create("h264", "r")
    for message in EpisodeFile.open(path).messages(recording.video_topic(camera)):
        video = codec.decode(CompressedVideo, message.payload)
        (picture,) = decoder.decode(av.Packet(video.data))
        yield video.timestamp.ToNanoseconds(), picture.to_ndarray(format="rgb24")[240, 320].tolist()


def recorded_ticks(path: Path) -> list[int]:
    return [message.sequence for message in EpisodeFile.open(path).messages(recording.STATE)]


def test_kill_9_loses_nothing_and_nothing_is_recorded_twice(endpoint: str, bus: Bus, tmp_path: Path) -> None:
    """20 Hz: a second is 20 ticks. What the killed one had not kept is asked for again."""
    first = synthetic.states(100)
    with closing(Ear(bus)) as ear, closing(ToyRoom(bus)) as room:
        with recorder(endpoint, tmp_path) as running:
            room.say(synthetic.started())
            room.play(first[:61])
            gone = threading.Event()
            with closing(bus.watch(_ALIVE, lambda _key, alive: None if alive else gone.set())):
                running.kill()
                assert gone.wait(1.0), "nobody was told within a second"
            (part,) = tmp_path.rglob("*.mcap.part")
            assert recorded_ticks(part)[-1] >= 60 - 20
        with recorder(endpoint, tmp_path):
            ear.await_saved(1)
            room.play(first[61:])
            room.say(synthetic.ended(100))
            ear.await_saved(2)
            room.say(synthetic.started(2, 200))
            room.play(synthetic.states(20, number=2, first_tick=200))
            room.say(synthetic.ended(220, 2))
            ear.await_saved(3)
        with recorder(endpoint, tmp_path):
            room.say(synthetic.started(3, 300))
            room.play(synthetic.states(20, number=3, first_tick=300))
            room.say(synthetic.ended(320, 3))
            *saved, third = ear.await_saved(4)
    assert (third.number, len(list(tmp_path.rglob("*.mcap")))) == (3, 4)
    repaired, rest, second = (tmp_path / event.path for event in saved)
    assert EpisodeFile.open(repaired).episode.repaired
    assert recorded_ticks(repaired) == list(range(recorded_ticks(repaired)[-1] + 1))
    assert recorded_ticks(rest) == list(range(101))
    assert EpisodeFile.open(rest).episode.outcome == "success"
    assert EpisodeFile.open(rest).episode.complete
    assert EpisodeFile.open(second).episode.complete


def test_a_frozen_recorder_asks_for_what_it_missed(endpoint: str, bus: Bus, tmp_path: Path) -> None:
    """Longer than its link lives, and across the end of the episode."""
    states = synthetic.states(100)
    with closing(Ear(bus)) as ear, closing(ToyRoom(bus)) as room, recorder(endpoint, tmp_path) as running:
        room.say(synthetic.started())
        room.play(states[:20])
        with running.frozen():
            room.play(states[20:], period_s=0.08)
            room.say(synthetic.ended(100))
        (saved,) = ear.await_saved(1)
    assert recorded_ticks(tmp_path / saved.path) == list(range(101))
    episode = EpisodeFile.open(tmp_path / saved.path).episode
    assert (episode.outcome, episode.complete) == ("success", True)
    assert (saved.missing_ticks, saved.missing_commands) == (0, 0)


def _ask(bus: Bus, topic: keys.Topic, request: SeatRequest | EpisodeRequest) -> None:
    raise_error(codec.decode(RoomReply, bus.query(topic, codec.encode(request), 5.0)).error)


def _begin_episode(bus: Bus) -> None:
    """As soon as the room is in practice."""
    deadline_s = clock.monotonic_s() + _PATIENCE_S
    ready = EpisodeRequest(ready=EpisodeRequest.Ready(arm="arm0", ready=True))
    while True:
        try:
            return _ask(bus, keys.episode(_ROOM), ready)
        except Conflict:  # the episode before has just ended
            if clock.monotonic_s() > deadline_s:
                raise
            clock.sleep_s(0.1)


def test_an_episode_of_two_scripts_is_recorded_and_verified_bit_for_bit(
    endpoint: str, bus: Bus, tmp_path: Path
) -> None:
    """And what a real camera of the room captured is in its file, as captured."""
    video = write_video(tmp_path / "blue.avi", _BLUE)
    services = {
        ("sim", "--room", _ROOM, "--control-hz", "20", "--camera", "table"): ("sim", _ROOM),
        ("camera", "--room", _ROOM, "--camera", f"table={video}"): ("camera", f"{_ROOM}-table"),
        ("replica",): ("replica", "replica-1"),
        ("experts",): ("experts", "experts"),
        ("recorder",): ("recorder", "recorder-1"),
    }
    with ExitStack() as running, closing(Ear(bus)) as ear:
        for command, (kind, name) in services.items():
            running.enter_context(running_service(command, endpoint, tmp_path, kind=kind, id=name))
        for arm in ("arm0", "arm1"):
            assign = SeatRequest.Assign(arm=arm, operator=OPERATOR_SCRIPT)
            _ask(bus, keys.seat(_ROOM), SeatRequest(assign=assign))
        _begin_episode(bus)
        (saved,) = ear.await_saved(1)
        path = tmp_path / saved.path
        listed = mart(endpoint, tmp_path, "episodes", "list")["episodes"]
        verified = mart(endpoint, tmp_path, "episodes", "verify", str(path))
        replayed = mart(endpoint, tmp_path, "episodes", "replay", str(path))
    assert (saved.verified, saved.verdict) == (True, "verified"), EpisodeFile.open(path).verification.detail
    assert isinstance(listed, list)
    (row,) = listed
    assert row["path"] == str(path)
    assert (row["outcome"], row["verified"], row["complete"]) == ("success", True, True)
    assert row["operators"] == {"arm0": "script", "arm1": "script"}
    assert row["real_time_factor"] > 0.9
    assert isinstance(verified["episodes"], list)
    (said,) = verified["episodes"]
    assert (said["path"], said["verdict"]) == (str(path), "verified")
    assert said["detail"] == f"{row['ticks']} ticks re-simulated bit for bit."
    episode = EpisodeFile.open(path).episode
    assert episode.captured_cameras == ("table",)
    captured = [*pictures_of(path, "table")]
    assert len(captured) > 0.5 * row["ticks"]
    times_ns = [at_ns for at_ns, _ in captured]
    assert times_ns == sorted(set(times_ns))
    assert episode.started_ns < times_ns[-1] < episode.ended_ns + 1_000_000_000
    assert all(colour == pytest.approx(_BLUE, abs=25) for _, colour in captured[:: len(captured) // 5])
    assert replayed["stretches"] == [
        {"first_tick": episode.first_tick, "last_tick": episode.last_tick, "different": []}
    ]
