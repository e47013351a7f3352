"""The recorder on a bus: from the first state to the announcement of a verified file, and when things go wrong."""

from __future__ import annotations

import resource
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

import pytest

from mart.episodes.reader import EpisodeFile
from mart.protocol import clock, codec, keys, recording
from mart.protocol.errors import InvalidInput
from mart.protocol.keys import Topic
from mart.protocol.messages import Event, State
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.catalogue.episode_catalogue import FILE_NAME
from mart.recorder.record.inbox import Inbox, RoomSubscriptions
from mart.recorder.record.recorder import Recorder
from mart.recorder.service import tidy
from mart.recorder.verify.resimulation import replica, verify
from mart.runtime.bus import Request, Sample
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork
from tests.recorder import synthetic
from tests.recorder.files import write_part

_PATIENCE_S = 20.0


def _answer_model(request: Request) -> None:
    request.reply(codec.encode(synthetic.MODEL))


class Session:
    """A recorder on an in-memory bus with a room and a replica that are toys."""

    def __init__(
        self,
        data_dir: Path,
        inbox: Inbox | None = None,
        answer_model: Callable[[Request], None] | None = None,
    ) -> None:
        self.data_dir = data_dir
        network = MemoryNetwork()
        self.bus: MemoryBus = network.connect()
        self.events: list[Event] = []
        self._told = threading.Condition()
        self.bus.subscribe(keys.EVERY_EVENT, self._hear)
        self.bus.serve(keys.model(synthetic.ROOM), answer_model or _answer_model)
        self.bus.announce(keys.alive(ServiceKind.REPLICA, "replica-1"))
        self.bus.serve(
            keys.rollout("replica-1"), lambda request: request.reply(synthetic.rollout_reply(request.payload))
        )
        self.inbox = inbox or Inbox()
        ask = replica(self.bus, "replica-1")

        def verify_file(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
            return verify(file, room, ask)

        root = data_dir / "episodes"
        self.recorder = Recorder(data_dir, self.bus, self.inbox, verify_file, lambda: tidy(root, verify_file))
        self.capture = RoomSubscriptions(network.connect(), network.connect(), self.inbox)

    def put(self, topic: Topic, payload: bytes) -> None:
        self.bus.publisher(topic).put(payload)

    def event(self, event: Event) -> None:
        self.put(keys.event(synthetic.ROOM), codec.encode(event))

    def states(self, states: list[State]) -> None:
        for state in states:
            self.put(keys.state(synthetic.ROOM), codec.encode(state))
            self.recorder.step(0.0)

    def episode(self, ticks: int = 10, number: int = 1, first_tick: int = 0) -> None:
        self.event(synthetic.started(number, first_tick))
        self.states(synthetic.states(ticks, number, first_tick))
        self.event(synthetic.ended(first_tick + ticks, number))

    def until(self, holds: Callable[[], object]) -> None:
        """Steps until something holds."""
        deadline_s = clock.monotonic_s() + _PATIENCE_S
        while not holds():
            assert clock.monotonic_s() < deadline_s
            self.recorder.step(0.02)

    def told(self, kind: str, count: int = 1) -> list[Event]:
        """Steps until so many events of a kind have been heard; returns them."""
        deadline_s = clock.monotonic_s() + _PATIENCE_S
        while clock.monotonic_s() < deadline_s:
            self.recorder.step(0.02)
            found = [event for event in self.events if event.WhichOneof("what") == kind]
            if len(found) >= count:
                return found
        raise AssertionError(f"{count} × {kind} was not heard; {self.events}")

    def close(self) -> None:
        self.capture.close()
        self.recorder.close()
        self.bus.close()

    def _hear(self, sample: Sample) -> None:
        with suppress(InvalidInput):  # a test sends garbage
            self.events.append(codec.decode(Event, sample.payload))


@pytest.fixture
def session(tmp_path: Path) -> Iterator[Session]:
    with closing(Session(tmp_path)) as opened:
        yield opened


def test_an_episode_is_recorded_verified_and_announced(session: Session) -> None:
    session.episode()
    (event,) = session.told("episode_saved")
    saved = event.episode_saved
    path = session.data_dir / saved.path
    assert saved.path == f"episodes/2026-09-21/room-1-0001-{synthetic.TASK}.mcap"
    assert (saved.verified, saved.verdict, saved.number) == (True, "verified", 1)
    assert saved.size_bytes == path.stat().st_size
    file = EpisodeFile.open(path)
    assert file.episode.complete
    assert file.model() == synthetic.MJB
    assert [m.payload for m in file.messages(recording.STATE)] == [
        codec.encode(s) for s in synthetic.states(10)
    ]


def test_commands_and_video_of_the_room_are_in_the_file(session: Session) -> None:
    def one_of_each(sequence: int) -> None:
        command, video = synthetic.command(sequence), synthetic.video(sequence, is_key=sequence == 1)
        session.put(keys.command(synthetic.ROOM, "arm0"), codec.encode(command))
        session.put(keys.video(synthetic.ROOM, "arm0"), codec.encode(video))

    one_of_each(1)
    session.states(synthetic.states(5))
    one_of_each(2)
    session.event(synthetic.ended(5))
    (event,) = session.told("episode_saved")
    file = EpisodeFile.open(session.data_dir / event.episode_saved.path)
    assert [m.sequence for m in file.messages("/arm/arm0/command")] == [1, 2]
    assert len(list(file.messages("/view/arm0/video"))) == 2


def test_each_episode_has_its_file_and_the_catalogue_knows_them(session: Session) -> None:
    for number in (1, 2, 3):
        session.episode(number=number, first_tick=100 * number)
    session.told("episode_saved", 3)
    session.recorder.close()
    assert len(list(session.data_dir.rglob("*.mcap"))) == 3
    assert (session.data_dir / "episodes" / FILE_NAME).exists()


def test_two_rooms_are_recorded_at_once(session: Session) -> None:
    for mine, other in zip(synthetic.states(5), synthetic.states(5, room="room-2"), strict=True):
        session.put(keys.state("room-1"), codec.encode(mine))
        session.put(keys.state("room-2"), codec.encode(other))
        session.recorder.step(0.0)
    session.close()
    rooms = [event.room for event in session.events if event.HasField("episode_saved")]
    assert sorted(rooms) == ["room-1", "room-2"]


def test_an_outcome_whose_event_was_lost_is_learned_from_the_status(session: Session) -> None:
    session.event(synthetic.started())
    session.states(synthetic.states(10))
    for _ in range(3):
        session.put(keys.status(synthetic.ROOM), codec.encode(synthetic.episode_status(10)))
    (event,) = session.told("episode_saved")
    record = EpisodeFile.open(session.data_dir / event.episode_saved.path).episode
    assert (record.outcome, record.reason, record.complete) == ("failure", "time is up", True)


def test_a_model_that_was_not_to_be_had_is_asked_for_again_when_an_episode_begins(tmp_path: Path) -> None:
    asked = threading.Event()

    def answer_late(request: Request) -> None:
        if asked.is_set():
            request.reply(codec.encode(synthetic.MODEL))
        asked.set()

    with closing(Session(tmp_path, answer_model=answer_late)) as session:
        session.put(keys.status(synthetic.ROOM), codec.encode(synthetic.status()))
        session.recorder.step(0.0)
        assert asked.wait(_PATIENCE_S)
        session.recorder._tools.finalizer._workers.submit(lambda: None).result()
        session.event(synthetic.started())
        session.states(synthetic.states(10)[:1])
        session.until(lambda: session.recorder._tools.models.known(synthetic.ROOM, synthetic.BOOT))


def test_being_stopped_saves_what_there_is(session: Session) -> None:
    session.event(synthetic.started())
    session.states(synthetic.states(10)[:6])
    session.close()
    (path,) = session.data_dir.rglob("*.mcap")
    record = EpisodeFile.open(path).episode
    assert (record.ticks, record.complete, record.outcome) == (5, False, "unspecified")
    assert record.reason == "the recorder was stopped"


def test_a_glimpse_of_an_episode_that_is_over_leaves_no_file(session: Session) -> None:
    session.states(synthetic.states(5)[-1:])
    session.close()
    assert not list(session.data_dir.rglob("*.mcap*"))


@pytest.mark.parametrize("key", ["mart/room-1/state", "mart/room-1/event", "mart/room-1/arm/arm0/command"])
def test_garbage_is_counted_logged_once_a_second_and_harms_nobody(
    session: Session, key: str, caplog: pytest.LogCaptureFixture
) -> None:
    session.states(synthetic.states(10)[:5])
    for _ in range(50):
        session.put(Topic(key, keys.Priority.NORMAL), b"\xff\xff\xff garbage")
    session.states(synthetic.states(10)[5:])
    session.event(synthetic.ended(10))
    (event,) = session.told("episode_saved")
    assert event.episode_saved.verified
    assert len([record for record in caplog.records if "is ignored" in record.message]) == 1


def test_a_state_under_another_rooms_key_is_ignored(session: Session) -> None:
    session.put(keys.state("room-2"), codec.encode(synthetic.states(1)[0]))
    session.recorder.step(0.0)
    session.close()
    assert not list(session.data_dir.rglob("*.mcap*"))


def test_names_that_would_leave_the_folder_are_refused(session: Session) -> None:
    for key in ("mart/..%2f/state", "mart/UPPER/state"):
        session.put(Topic(key, keys.Priority.NORMAL), codec.encode(synthetic.states(1, room="..%2f")[0]))
    session.recorder.step(0.0)
    session.close()
    assert not list(session.data_dir.rglob("*.mcap*"))


@contextmanager
def no_file_larger_than(size_bytes: int) -> Iterator[None]:
    """Writes beyond it fail with OSError, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_full_disk_ends_that_recording_only(session: Session) -> None:
    session.event(synthetic.started())
    states = synthetic.states(400)
    session.states(states[:100])
    session.recorder._rooms[synthetic.ROOM].flush(0.0)
    (part,) = session.data_dir.rglob("*.part")
    with no_file_larger_than(part.stat().st_size + 4000):
        session.states(states[100:])
        (notice,) = session.told("notice")
    assert notice.notice.level == "error"
    assert "Recording of episode 1 stopped" in notice.notice.text
    assert str(part) in notice.notice.text
    kept = [m.sequence for m in EpisodeFile.open(part).messages(recording.STATE)]
    assert kept[:100] == list(range(100))

    session.event(synthetic.ended(400))
    session.episode(number=2, first_tick=500)
    (event,) = session.told("episode_saved")
    assert (event.episode_saved.number, event.episode_saved.verified) == (2, True)


def test_a_recorder_that_cannot_keep_up_leaves_out_frames_and_says_so(tmp_path: Path) -> None:
    with closing(Session(tmp_path, Inbox(video_bytes=5_000))) as session:
        session.states(synthetic.states(5)[:3])
        for frame in range(20):
            session.put(
                keys.video(synthetic.ROOM, "arm0"), codec.encode(synthetic.video(frame, is_key=frame == 0))
            )
        session.states(synthetic.states(5)[3:])
        session.event(synthetic.ended(5))
        (event,) = session.told("episode_saved")
        (notice,) = session.told("notice")
    file = EpisodeFile.open(tmp_path / event.episode_saved.path)
    kept = len(list(file.messages("/view/arm0/video")))
    assert 0 < kept < 20
    assert file.cadence.video_dropped == 20 - kept
    assert file.cadence.messages_lost == 0
    assert len(list(file.messages(recording.STATE))) == 6
    assert (notice.notice.level, f"{20 - kept} frames were lost" in notice.notice.text) == ("warning", True)


def test_leftovers_are_repaired_at_the_start(tmp_path: Path) -> None:
    file, _, _ = write_part(tmp_path / "episodes", synthetic.states(10))
    file.flush()
    file.abandon()
    stop = threading.Event()
    with closing(Session(tmp_path)) as session:
        runs = threading.Thread(target=session.recorder.run, args=[stop])
        runs.start()
        stop.set()
        runs.join()
        (event,) = (event for event in session.events if event.HasField("episode_saved"))
    assert event.episode_saved.verified
    assert EpisodeFile.open(tmp_path / event.episode_saved.path).episode.repaired
