"""Which folders may be asked for, and what is found there."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput
from mart.trainer.jobs.service.data_folders import DataFolders, episode_files


@pytest.fixture
def data_dir(tmp_path: Path) -> Path:
    folder = tmp_path / "data"
    (folder / "episodes").mkdir(parents=True)
    return folder


@pytest.mark.parametrize("given", ["episodes", "episodes/2026-11-22", "./episodes/../episodes", "nowhere"])
def test_folders_below_the_data_folder_may_be_asked_for(data_dir: Path, given: str) -> None:
    assert DataFolders(data_dir).find(given) == (data_dir / given).resolve()


@pytest.mark.parametrize(
    "given", ["/", "/proc", "..", "episodes/../../other", "/etc/passwd", "a\0b", "x" * 300]
)
def test_no_other_may_nor_what_is_no_path(data_dir: Path, given: str) -> None:
    with pytest.raises(InvalidInput):
        DataFolders(data_dir).find(given)


def test_a_link_on_the_way_is_followed_before_it_is_compared(data_dir: Path, tmp_path: Path) -> None:
    (data_dir / "episodes" / "out").symlink_to(tmp_path)
    with pytest.raises(InvalidInput):
        DataFolders(data_dir).find("episodes/out")


def test_the_owner_may_link_or_name_folders_elsewhere(data_dir: Path, tmp_path: Path) -> None:
    linked, named = tmp_path / "linked", tmp_path / "named"
    linked.mkdir()
    (data_dir / "big").symlink_to(linked)
    folders = DataFolders(data_dir, [named])
    assert folders.find("big/2026-11-22") == linked / "2026-11-22"
    assert folders.find(str(named / "lab")) == named / "lab"


@given(st.text(max_size=40))
def test_whatever_is_asked_for_is_below_the_data_folder_or_refused(
    tmp_path_factory: pytest.TempPathFactory, asked: str
) -> None:
    data_dir = tmp_path_factory.getbasetemp()
    try:
        found = DataFolders(data_dir).find(asked)
    except InvalidInput:
        return
    assert found.is_relative_to(data_dir)


def test_a_folder_is_walked_as_far_as_one_of_episodes_can_go(data_dir: Path) -> None:
    for number in range(10):
        (data_dir / "episodes" / f"{number}.mcap").touch()
    (data_dir / "episodes" / "notes.txt").touch()
    assert [file.name for file in episode_files(data_dir)] == [f"{number}.mcap" for number in range(10)]
    with pytest.raises(InvalidInput):
        episode_files(data_dir, max_entries=11)
    assert episode_files(data_dir / "nowhere") == []
