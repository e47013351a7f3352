"""The recorder on a bus: from the first state to the announcement of a verified file, and when things go wrong."""

from __future__ import annotations

import errno
import os
import resource
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from mart.episodes.patient_file import PatientFile
from mart.episodes.reader import EpisodeFile
from mart.protocol import codec, keys, recording
from mart.protocol.keys import Topic
from mart.recorder.catalogue.episode_catalogue import FILE_NAME
from mart.recorder.record import folder_watch
from mart.recorder.record.inbox import Inbox
from mart.recorder.verify.file_check import check_file
from mart.runtime.bus import Request
from tests.recorder import synthetic
from tests.recorder.files import write_part
from tests.recorder.record.recording_session import PATIENCE_S, RecordingSession


@pytest.fixture
def session(tmp_path: Path) -> Iterator[RecordingSession]:
    with closing(RecordingSession(tmp_path)) as opened:
        yield opened


def test_an_episode_is_recorded_verified_and_announced(session: RecordingSession) -> None:
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


def test_commands_and_video_of_the_room_are_in_the_file(session: RecordingSession) -> None:
    def one_of_each(sequence: int) -> None:
        command, video = synthetic.command(sequence), synthetic.video(sequence, is_key=sequence == 0)
        session.put(keys.command(synthetic.ROOM, "arm0"), codec.encode(command))
        session.put(keys.video(synthetic.ROOM, "arm0"), codec.encode(video))

    one_of_each(0)
    session.states(synthetic.states(5))
    one_of_each(6)
    session.event(synthetic.ended(5))
    (event,) = session.told("episode_saved")
    file = EpisodeFile.open(session.data_dir / event.episode_saved.path)
    assert [m.sequence for m in file.messages("/arm/arm0/command")] == [0, 1, 2, 3, 4, 5, 6]
    assert file.cadence.missing_commands == check_file(file.path).missing_commands == 0
    assert len(list(file.messages("/view/arm0/video"))) == 2


def test_a_command_that_never_comes_is_counted_in_the_file_and_told(
    session: RecordingSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mart.recorder.record.episode_closing.GRACE_S", 0.2)
    states = synthetic.states(5)
    session.states(states[:3])
    states[3].arms[0].sequence = 99
    session.put(keys.state(synthetic.ROOM), codec.encode(states[3]))  # without the command that it names
    for state in states[4:]:
        state.arms[0].sequence += 100
    session.states(states[4:])
    session.event(synthetic.ended(5))
    (event,) = session.told("episode_saved")
    file = EpisodeFile.open(session.data_dir / event.episode_saved.path)
    assert (
        event.episode_saved.missing_commands
        == file.cadence.missing_commands
        == check_file(file.path).missing_commands
        == 1
    )
    assert event.episode_saved.verified


def test_a_file_that_waits_keeps_its_rate_when_the_room_begins_anew_at_another(
    session: RecordingSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The sim is started again at 60 Hz, with another model, while the last command of the episode is awaited."""
    monkeypatch.setattr("mart.recorder.record.episode_closing.GRACE_S", 0.5)
    session.event(synthetic.started())
    session.states(synthetic.states(4))
    session.put(keys.state(synthetic.ROOM), codec.encode(synthetic.states(5)[5]))  # its command does not come
    session.event(synthetic.ended(5))
    anew = synthetic.status(boot=synthetic.BOOT + 1)
    anew.control_hz = 60.0
    session.put(keys.status(synthetic.ROOM), codec.encode(anew))
    (event,) = session.told("episode_saved")
    file = EpisodeFile.open(session.data_dir / event.episode_saved.path)
    assert (file.room.control_hz, file.episode.control_hz) == (20.0, 20.0)
    assert file.room.model_sha256 == synthetic.MODEL.sha256


def test_each_episode_has_its_file_and_the_catalogue_knows_them(session: RecordingSession) -> None:
    for number in (1, 2, 3):
        session.episode(number=number, first_tick=100 * number)
    session.told("episode_saved", 3)
    session.recorder.close()
    assert len(list(session.data_dir.rglob("*.mcap"))) == 3
    assert (session.data_dir / "episodes" / FILE_NAME).exists()


def test_two_rooms_are_recorded_at_once(session: RecordingSession) -> None:
    for mine, other in zip(synthetic.states(5), synthetic.states(5, room="room-2"), strict=True):
        session.put(keys.state("room-1"), codec.encode(mine))
        session.put(keys.state("room-2"), codec.encode(other))
        session.recorder.step(0.0)
    session.close()
    rooms = [event.room for event in session.events if event.HasField("episode_saved")]
    assert sorted(rooms) == ["room-1", "room-2"]


def test_an_outcome_whose_event_was_lost_is_learned_from_the_status(session: RecordingSession) -> None:
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

    with closing(RecordingSession(tmp_path, answer_model=answer_late)) as session:
        session.put(keys.status(synthetic.ROOM), codec.encode(synthetic.status()))
        session.recorder.step(0.0)
        assert asked.wait(PATIENCE_S)
        session.recorder._tools.finalizer._fetchers.submit(lambda: None).result()
        session.event(synthetic.started())
        session.states(synthetic.states(10)[:1])
        session.until(lambda: session.recorder._tools.models.known(synthetic.ROOM, synthetic.BOOT))


def test_being_stopped_saves_what_there_is(session: RecordingSession) -> None:
    session.event(synthetic.started())
    session.states(synthetic.states(10)[:6])
    session.close()
    (path,) = session.data_dir.rglob("*.mcap")
    record = EpisodeFile.open(path).episode
    assert (record.ticks, record.complete, record.outcome) == (5, False, "unspecified")
    assert record.reason == "the recorder was stopped"


def test_a_glimpse_of_an_episode_that_is_over_leaves_no_file(session: RecordingSession) -> None:
    session.states(synthetic.states(5)[-1:])
    session.close()
    assert not list(session.data_dir.rglob("*.mcap*"))


@pytest.mark.parametrize("key", ["mart/room-1/state", "mart/room-1/event", "mart/room-1/arm/arm0/command"])
def test_garbage_is_counted_logged_once_a_second_and_harms_nobody(
    session: RecordingSession, key: str, caplog: pytest.LogCaptureFixture
) -> None:
    session.states(synthetic.states(10)[:5])
    for _ in range(50):
        session.put(Topic(key, keys.Priority.NORMAL), b"\xff\xff\xff garbage")
    session.states(synthetic.states(10)[5:])
    session.event(synthetic.ended(10))
    (event,) = session.told("episode_saved")
    assert event.episode_saved.verified
    assert len([record for record in caplog.records if "is ignored" in record.message]) == 1


def test_a_state_under_another_rooms_key_is_ignored(session: RecordingSession) -> None:
    session.put(keys.state("room-2"), codec.encode(synthetic.states(1)[0]))
    session.recorder.step(0.0)
    session.close()
    assert not list(session.data_dir.rglob("*.mcap*"))


def test_names_that_would_leave_the_folder_are_refused(session: RecordingSession) -> None:
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


def test_a_full_disk_ends_that_recording_only(session: RecordingSession) -> None:
    session.event(synthetic.started())
    states = synthetic.states(400)
    session.states(states[:100])
    session.recorder._rooms[synthetic.ROOM]._flush(0.0)
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


@pytest.mark.parametrize("reason", [errno.ENOSPC, errno.EROFS])
def test_a_disk_that_is_full_for_a_while_costs_nothing(
    session: RecordingSession, monkeypatch: pytest.MonkeyPatch, reason: int
) -> None:
    full, drain = threading.Event(), PatientFile._drain

    def drain_if_there_is_room(file: PatientFile) -> None:
        if full.is_set():
            raise OSError(reason, os.strerror(reason))
        drain(file)

    monkeypatch.setattr(PatientFile, "_drain", drain_if_there_is_room)
    monkeypatch.setattr(folder_watch, "trouble_of", lambda _: "The disk is full" if full.is_set() else "")
    states = synthetic.states(60)
    session.event(synthetic.started())
    session.states(states[:20])
    full.set()
    session.states(states[20:])
    session.recorder._rooms[synthetic.ROOM]._flush(0.0)
    (notice,) = session.told("notice")
    assert (notice.notice.level, "waits in memory" in notice.notice.text) == ("error", True)
    session.event(synthetic.ended(60))
    session.recorder.step(0.3)  # longer than a retry
    assert not list(session.data_dir.rglob("*.mcap"))
    full.clear()
    (event,) = session.told("episode_saved")
    file = EpisodeFile.open(session.data_dir / event.episode_saved.path)
    assert (event.episode_saved.verified, file.episode.complete) == (True, True)
    assert [message.sequence for message in file.messages(recording.STATE)] == list(range(61))


def test_a_recorder_that_cannot_keep_up_leaves_out_frames_and_says_so(tmp_path: Path) -> None:
    with closing(RecordingSession(tmp_path, Inbox(video_bytes=5_000))) as session:
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
    with closing(RecordingSession(tmp_path)) as session:
        runs = threading.Thread(target=session.recorder.run, args=[stop])
        runs.start()
        stop.set()
        runs.join()
        (event,) = (event for event in session.events if event.HasField("episode_saved"))
    assert event.episode_saved.verified
    assert EpisodeFile.open(tmp_path / event.episode_saved.path).episode.repaired
