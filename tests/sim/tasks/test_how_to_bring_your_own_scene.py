"""docs/how-to-bring-your-own-scene.md: what it shows is in the example, its commands run, and its tables are whole."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import get_args

import pytest
from click.testing import CliRunner
from pydantic import BaseModel

from mart.envs import make_env
from mart.protocol.tasks import task_file as schema
from mart.protocol.tasks.conditions import Condition
from mart.runtime.cli import cli
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World
from tests.contract.repository import ROOT
from tests.support.drawer_demonstration import TASK_FILE

_PAGE = (ROOT / "docs/how-to-bring-your-own-scene.md").read_text()
_COMMANDS = re.findall(r"^\$ mart (tasks .*)$", _PAGE, re.MULTILINE)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MART_TASK_FILES", "")
    monkeypatch.setenv("MART_TASKS_DIR", str(TASK_FILE.parent))


def _plain(text: str) -> str:
    return " ".join(text.split())


def test_what_it_shows_is_in_the_example() -> None:
    sources = {"toml": TASK_FILE.read_text(), "xml": TASK_FILE.with_suffix(".xml").read_text()}
    shown = re.findall(r"^```(toml|xml)\n(.*?)^```", _PAGE, re.MULTILINE | re.DOTALL)
    assert len(shown) > 4
    assert [text for kind, text in shown if _plain(text) not in _plain(sources[kind])] == []


@pytest.mark.slow
def test_its_commands_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert len(_COMMANDS) == 3
    for command in _COMMANDS:
        words = [word if word != "pictures" else str(tmp_path) for word in shlex.split(command)]
        words = [str(ROOT / word) if word.startswith("examples/") else word for word in words]
        result = CliRunner().invoke(cli, words)
        assert result.exit_code == 0, result.output
    assert len(list(tmp_path.glob("two_arm_drawer-*.png"))) == 3


def test_its_tables_name_all_that_can_be_said() -> None:
    union = get_args(get_args(Condition)[0])
    for sort in union:
        word = get_args(sort.model_fields["is_"].annotation)[0]
        row = next(
            line
            for line in _PAGE.splitlines()
            if line.startswith("| `") and f"`{word}`" in line.split("|")[1]
        )
        assert all(f"`{name}`" in row for name in sort.model_fields if name != "is_"), row
    parts = [
        one
        for one in vars(schema).values()
        if isinstance(one, type) and issubclass(one, BaseModel) and one.model_fields
    ]
    said = {name for part in parts if part.__module__ == schema.__name__ for name in part.model_fields}
    told = said - {
        "name",
        "text",
        "folder",
        "scene",
        "arms",
        "objects",
        "regions",
        "subtasks",
        "success",
        "failures",
    }
    assert sorted(name for name in told - {"cameras"} if f"`{name}`" not in _PAGE) == []


def test_scripts_do_it() -> None:
    progress = run_experts(World.build("two_arm_drawer", kinds=("ur5e", "panda")), 3, until_s=30.0)
    assert progress.success


def test_it_is_an_environment_too() -> None:
    env = make_env(str(TASK_FILE))
    try:
        observations, _ = env.reset(seed=1)
        assert observations["peg/position_in_world"].shape == (3,)
        assert env.action_space.shape == (2, 7)
    finally:
        env.close()
