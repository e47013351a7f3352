"""`mart tasks`: what is listed and shown, and what is said of task files that cannot be used."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import task_names
from mart.runtime.cli import cli
from tests.support.drawer_demonstration import TASK_FILE


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MART_TASKS_DIR", str(tmp_path))
    monkeypatch.setenv("MART_TASK_FILES", "")
    return tmp_path


def copied(folder: Path, old: str = "", new: str = "") -> Path:
    assert old in TASK_FILE.read_text()
    (folder / TASK_FILE.name).write_text(TASK_FILE.read_text().replace(old, new, 1))
    (folder / "two_arm_drawer.xml").write_text(TASK_FILE.with_suffix(".xml").read_text())
    return folder / TASK_FILE.name


def test_the_tasks_are_listed_as_they_are_given(folder: Path) -> None:
    copied(folder)
    (folder / "broken.toml").write_text("title = ")
    listed = CliRunner().invoke(cli, ["tasks"]).output.splitlines()
    assert [line.split()[0] for line in listed[:-1]] == list(task_names())
    assert "Multi-cube lifting, 2, 3 or 4 arms" in listed[task_names().index("two_arm_multi_cube_lifting")]
    assert "Peg into the drawer, 2 arms" in listed[task_names().index("two_arm_drawer")]
    assert "not TOML" in listed[task_names().index("broken")]
    for words in (["tasks", "--json"], ["tasks", "list", "--json"]):
        told = json.loads(CliRunner().invoke(cli, words).output)["tasks"]
        (cubes,) = [task for task in told if task["name"] == "two_arm_multi_cube_lifting"]
        assert (cubes["title"], cubes["arm_counts"]) == ("Multi-cube lifting", [2, 3, 4])


def test_one_is_shown_by_its_name_or_its_file(folder: Path) -> None:
    shown = CliRunner().invoke(cli, ["tasks", "show", str(TASK_FILE)]).output
    assert "peg/position_in_world [3] m: arm0, arm1" in shown
    assert "time_limit_s" in json.loads(
        CliRunner().invoke(cli, ["tasks", "show", "three_arm_lift_wiping", "--json"]).output
    )


def test_a_file_is_checked(folder: Path) -> None:
    good = CliRunner().invoke(cli, ["tasks", "check", str(copied(folder))])
    assert (good.exit_code, good.output.strip()) == (0, "It can be used.")
    bad = CliRunner().invoke(cli, ["tasks", "check", str(copied(folder, "at_least = 0.10", "at_least = -1"))])
    assert bad.exit_code == 1
    assert "done where it begins" in bad.output
    unknown = CliRunner().invoke(
        cli, ["tasks", "check", str(copied(folder, "yaw_rad = 3.1", "yaw_deg = 3.1"))]
    )
    assert isinstance(unknown.exception, InvalidInput)
    assert "arms[2].yaw_deg" in str(unknown.exception)
