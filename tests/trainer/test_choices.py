"""What the trainer offers to learn from."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.trainer.service.choices import data_sets

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
