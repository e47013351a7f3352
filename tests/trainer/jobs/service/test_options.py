"""What the trainer offers to learn from."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.episodes.labels import Label, LabelKind, append
from mart.trainer.jobs.service.options import data_sets

CUBES, TRAY = "two_arm_multi_cube_lifting", "two_arm_drink_tray_lifting"


@pytest.fixture
def data_dir(tmp_path: Path) -> Path:
    for name in (
        f"episodes/2026-11-22/room-1-0001-{CUBES}.mcap",
        f"episodes/2026-11-22/room-1-0002-{TRAY}.mcap",
        f"episodes/2026-11-23/room-1-0003-{TRAY}-2.mcap",
        "collected/renamed.mcap",
        f"runs/kept/room-1-0001-{CUBES}.mcap",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    return tmp_path


def test_data_sets_are_folders_with_the_tasks_of_their_episodes(data_dir: Path) -> None:
    found = [(one.path, one.episodes, list(one.tasks)) for one in data_sets(data_dir)]
    assert found == [("episodes", 3, [TRAY, CUBES]), ("collected", 1, [])]


def test_named_data_sets_follow_their_folder_and_say_what_is_left_of_them(data_dir: Path) -> None:
    first, second, gone = (
        f"2026-11-22/room-1-0002-{TRAY}.mcap",
        f"2026-11-23/room-1-0003-{TRAY}-2.mcap",
        "x.mcap",
    )
    joined = [Label(path, LabelKind.JOIN, "trays", 1) for path in (first, second, gone)]
    append(data_dir / "episodes", [*joined, Label(first, LabelKind.USE, "drop", 2)])
    folder, named, other = data_sets(data_dir)
    assert [one.path for one in (folder, named, other)] == ["episodes", "episodes", "collected"]
    assert (folder.name, named.name, list(named.tasks)) == ("", "trays", [TRAY])
    assert (named.episodes, named.left_out, len(named.sha256)) == (3, 2, 64)
