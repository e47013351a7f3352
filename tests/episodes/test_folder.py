"""Listing a folder straight from its files, and finding the files of one episode."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.episodes import EpisodeFilter, LabelKind, find_episodes, labels, list_episodes
from mart.protocol.errors import Corrupt, NotFound
from mart.recorder.record.finalize import finalize
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_episode, write_part


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for number in (1, 2, 12):
        write_episode(tmp_path, ticks=3, number=number)
    return tmp_path


def test_a_folder_a_file_and_several_are_listed_once_each(root: Path) -> None:
    every = list_episodes(root)
    assert [one.number for one in every] == [1, 2, 12]
    assert list_episodes(str(root)) == every
    first = every[0].file_path
    assert [one.number for one in list_episodes([root, first, first.parent])] == [1, 2, 12]
    assert list_episodes(first)[0].path == first.relative_to(root).as_posix()
    assert list_episodes([]) == []


def test_the_oldest_comes_first_whatever_files_are_called(root: Path) -> None:
    file, episode, facts = write_part(root, synthetic.states(3, number=0, first_tick=100))
    finalize(file, episode, facts, root, by_toy_replica, repaired=False)
    assert [one.number for one in list_episodes(root)] == [1, 2, 12, 0]


def test_a_path_keeps_its_spelling(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(root)
    listed = list_episodes("2026-09-21")
    assert {one.file_path.parent for one in listed} == {Path("2026-09-21")}
    assert {one.path.split("/")[0] for one in listed} == {"2026-09-21"}


def test_labels_lie_over_what_is_listed(root: Path) -> None:
    second = list_episodes(root)[1].file_path
    labels.say(second, LabelKind.OUTCOME, "failure", 1)
    labels.say(second, LabelKind.JOIN, "few", 2)
    assert [one.number for one in list_episodes(root, EpisodeFilter(outcomes=("failure",)))] == [2]
    assert [one.number for one in list_episodes(root, EpisodeFilter(datasets=("few",)))] == [2]


def test_a_file_that_cannot_be_read_is_listed_with_the_reason(root: Path) -> None:
    broken = root / "2026-09-21" / "broken.mcap"
    broken.write_bytes(b"broken")
    (found,) = (one for one in list_episodes(root) if one.error is not None)
    assert found.file_path == broken
    with pytest.raises(Corrupt):
        found.open()


def test_one_episode_of_a_room_is_found_once_it_is_saved(root: Path) -> None:
    assert [one.number for one in find_episodes(root, synthetic.ROOM, 1)] == [1]
    assert find_episodes(root, synthetic.ROOM, 3) == []
    assert find_episodes(root, "room", 1) == []
    file, _, _ = write_part(root, synthetic.states(3, number=3))
    assert find_episodes(root, synthetic.ROOM, 3) == []  # it is being written
    file.discard()


def test_a_name_alone_makes_no_episode(root: Path) -> None:
    first = find_episodes(root, synthetic.ROOM, 1)[0].file_path
    first.rename(first.with_name(first.name.replace("0001", "0007")))
    assert find_episodes(root, synthetic.ROOM, 7) == []


def test_other_episodes_are_not_opened(root: Path) -> None:
    for path in root.rglob("*-0002-*"):
        path.write_bytes(b"broken")
    assert [one.error for one in find_episodes(root, synthetic.ROOM, 1)] == [None]


def test_a_folder_that_is_not_there_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(NotFound):
        list_episodes(tmp_path / "none")
    assert find_episodes(tmp_path / "none", "room-1", 1) == []
