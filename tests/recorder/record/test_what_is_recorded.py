"""Which rooms are recorded, and how a room learns that it is not."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec, keys
from mart.protocol.messages import RecordingReport, RoomStatus, State
from tests.recorder import synthetic
from tests.recorder.record.recording_session import RecordingSession


@pytest.fixture
def session(tmp_path: Path) -> Iterator[RecordingSession]:
    with closing(RecordingSession(tmp_path)) as opened:
        yield opened


def test_rooms_without_a_sim_take_no_place(session: RecordingSession) -> None:
    for number in range(80):
        status = RoomStatus(room=f"ghost-{number}", task=synthetic.TASK, boot=1)
        session.put(keys.status(status.room), codec.encode(status))
        session.put(keys.state(status.room), codec.encode(synthetic.states(1, room=status.room)[0]))
    session.recorder.step(0.0)
    assert not session.recorder._rooms
    session.episode()
    (event,) = session.told("episode_saved")
    assert event.episode_saved.verified
    session.live_rooms.clear()
    session.recorder.step(0.0)
    assert not session.recorder._rooms


def test_rooms_that_pretend_to_have_a_sim_never_stop_a_real_one(session: RecordingSession) -> None:
    ghosts = [f"ghost-{number}" for number in range(80)]
    session.live_rooms.update(ghosts)
    for ghost in ghosts:
        status = RoomStatus(room=ghost, task=synthetic.TASK, boot=1)
        session.put(keys.status(ghost), codec.encode(status))
    session.recorder.step(0.0)
    session.episode()
    (event,) = session.told("episode_saved")
    assert event.episode_saved.verified


def test_a_room_of_a_task_that_does_not_exist_is_told_that_it_is_not_recorded(
    session: RecordingSession,
) -> None:
    status = synthetic.status()
    status.task = "two_arm_flipped_bits"
    session.put(keys.status(synthetic.ROOM), codec.encode(status))
    session.episode()
    (notice,) = session.told("notice")
    assert "two_arm_flipped_bits" in notice.notice.text
    session.recorder.close()
    assert not list(session.data_dir.rglob("*.mcap*"))


def test_a_far_tick_is_no_state_of_the_episode(session: RecordingSession) -> None:
    states = synthetic.states(10)
    session.states(states[:5])
    forged = State.FromString(states[5].SerializeToString())
    forged.tick += 10**9
    session.put(keys.state(synthetic.ROOM), codec.encode(forged))
    session.states(states[5:])
    session.event(synthetic.ended(10))
    (event,) = session.told("episode_saved")
    assert (event.episode_saved.verified, event.episode_saved.missing_ticks) == (True, 0)
    assert EpisodeFile.open(session.data_dir / event.episode_saved.path).episode.complete


def test_a_room_hears_what_is_kept_of_its_episode(session: RecordingSession) -> None:
    heard: list[bytes] = []
    session.bus.subscribe(keys.recording(synthetic.ROOM).key, lambda sample: heard.append(sample.payload))
    session.states(synthetic.states(5))
    session.until(lambda: heard)
    report = RecordingReport.FromString(heard[-1])
    assert (report.recorder, report.boot, report.episode) == ("recorder-1", synthetic.BOOT, 1)


def test_a_file_that_is_deleted_while_it_is_written_is_told_at_once(session: RecordingSession) -> None:
    session.states(synthetic.states(5))
    (part,) = session.data_dir.rglob("*.part")
    part.unlink()
    (notice,) = session.told("notice")
    assert (notice.notice.level, "deleted" in notice.notice.text) == ("error", True)


def test_an_episode_that_has_its_file_is_not_recorded_again(tmp_path: Path) -> None:
    """A recorder that was started anew hears again what a room said before."""
    for _ in range(2):
        with closing(RecordingSession(tmp_path)) as session:
            session.episode(number=1)
            session.states(synthetic.states(3, number=2, first_tick=50))
            session.event(synthetic.ended(53, 2))
            session.until(lambda: len(list(tmp_path.rglob("*.mcap"))) == 2)
    assert len(list(tmp_path.rglob("*.mcap*"))) == 2


def test_two_recorders_of_a_folder_record_each_room_once(tmp_path: Path) -> None:
    with closing(RecordingSession(tmp_path)) as first, closing(RecordingSession(tmp_path)) as second:
        first.episode()
        second.episode()
        first.told("episode_saved")
        for state in synthetic.states(5, room="room-2"):  # a room of its own
            second.put(keys.state("room-2"), codec.encode(state))
        second.recorder.step(0.0)
    rooms = [EpisodeFile.open(path).episode.room for path in sorted(tmp_path.rglob("*.mcap"))]
    assert rooms == ["room-1", "room-2"]
    with closing(RecordingSession(tmp_path)) as third:  # who has left leaves the rooms to others
        third.episode(number=2, first_tick=50)
        third.told("episode_saved")
