"""Episodes of a collection are found by their files: the new ones, by room and number."""

from __future__ import annotations

import shutil
import tarfile
from pathlib import Path

import pytest

from mart.episodes.reader import EpisodeFile
from mart.platform.collect import saved_episodes
from mart.platform.collect.saved_episodes import SavedEpisodes
from mart.protocol.errors import Corrupt, Unavailable
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.vocabulary import EpisodeOutcome, Verdict
from mart.recorder.record.finalize import finalize
from mart.recorder.verify.replica import nobody
from mart.recorder.verify.resimulation import verify
from mart.recorder.verify.verdict_label import keep_verdict
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_episode, write_part

FIXTURES = Path(__file__).parents[2] / "fixtures" / "episodes_0_1_0" / "episodes.tar.xz"


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """One recorded file, not yet in the data folder."""
    with tarfile.open(FIXTURES) as archive:
        archive.extractall(tmp_path / "unpacked", filter="data")
    return next((tmp_path / "unpacked").rglob("*lockstep*.mcap"))


def put(recorded: Path, data_dir: Path, name: str) -> Path:
    path = data_dir / "episodes" / "2026-01-01" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(recorded, path)
    return path


def test_an_episode_is_found_when_its_file_is_there(recorded: Path, tmp_path: Path) -> None:
    written = EpisodeFile.open(recorded).episode
    saved = SavedEpisodes(tmp_path)
    assert saved.find(written.room, written.number) is None
    put(recorded, tmp_path, f"{written.room}-{written.number:04}-cubes.mcap")
    episode = saved.find(written.room, written.number)
    assert episode is not None
    assert (episode.number, episode.ticks, episode.verified) == (written.number, written.ticks, True)
    assert episode.outcome is EpisodeOutcome(written.outcome)
    assert saved.find(written.room, written.number + 1) is None


def test_what_was_there_before_does_not_count(recorded: Path, tmp_path: Path) -> None:
    written = EpisodeFile.open(recorded).episode
    put(recorded, tmp_path, f"{written.room}-{written.number:04}-cubes.mcap")
    assert SavedEpisodes(tmp_path).find(written.room, written.number) is None


def test_a_verdict_that_is_pending_is_awaited_for_a_while(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def by_nobody(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
        return verify(file, room, nobody(Unavailable("no router")))

    saved = SavedEpisodes(tmp_path)
    path = write_episode(tmp_path / "episodes", ticks=3, verify=by_nobody).path
    assert saved.find(synthetic.ROOM, 1) is None
    keep_verdict(path, VerificationRecord(verdict=Verdict.VERIFIED, detail=""), 1)
    found = saved.find(synthetic.ROOM, 1)
    assert found is not None
    assert found.verified
    write_episode(tmp_path / "episodes", 3, 2, by_nobody)
    monkeypatch.setattr(saved_episodes, "VERDICT_PATIENCE_S", 0.0)
    found = saved.find(synthetic.ROOM, 2)
    assert found is not None
    assert found.verdict is Verdict.UNVERIFIED


def test_of_several_files_of_an_episode_the_one_that_knows_the_outcome_counts(tmp_path: Path) -> None:
    saved = SavedEpisodes(tmp_path)
    root = tmp_path / "episodes"
    for _ in range(2):
        cut, episode, facts = write_part(root, synthetic.states(3), is_over=False)
        finalize(cut, episode, facts, root, by_toy_replica, repaired=False)
    first = saved.find(synthetic.ROOM, 1)
    assert first is not None
    assert first.outcome is EpisodeOutcome.UNSPECIFIED
    write_episode(root, ticks=3)
    second = saved.find(synthetic.ROOM, 1)
    assert second is not None
    assert second.outcome is EpisodeOutcome.SUCCESS


def test_a_file_that_is_no_episode_is_not_mistaken_for_one(recorded: Path, tmp_path: Path) -> None:
    saved = SavedEpisodes(tmp_path)
    put(recorded, tmp_path, "room-1-0099-cubes.mcap").write_bytes(b"no episode")
    try:
        assert saved.find("room-1", 99) is None
    except Corrupt:
        pytest.fail("a foreign file stands in the way of the collection")
