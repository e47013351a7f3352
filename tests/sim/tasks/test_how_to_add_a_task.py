"""docs/how-to-add-a-task.md, done to the letter: its files are put where it says, and what it promises holds."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.contract.repository import ROOT

_PAGE = (ROOT / "docs" / "how-to-add-a-task.md").read_text()
_FILES = dict(re.findall(r"^```python file=(\S+)\n(.*?)^```", _PAGE, re.MULTILINE | re.DOTALL))
_SOURCES = ("protocol/src", "services/sim/src")
_CHECKERS = (
    "tests/sim/envs/test_envs.py tests/protocol/tasks/test_catalogue.py tests/sim/scene/test_cameras.py"
)


@pytest.fixture(scope="module")
def followed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The parts that the page touches, with the page's files added."""
    tree = tmp_path_factory.mktemp("tree")
    for folder in (*_SOURCES, "tests"):
        shutil.copytree(
            ROOT / folder, tree / folder, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info")
        )
    for name, text in _FILES.items():
        (tree / name).write_text(text)
    shutil.copy(ROOT / "pyproject.toml", tree)
    return tree


def pytest_there(tree: Path, *arguments: str) -> None:
    paths = os.pathsep.join(str(tree / folder) for folder in _SOURCES)
    subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments],
        cwd=tree,
        env={**os.environ, "PYTHONPATH": paths},
        check=True,
    )


def test_the_page_names_each_file_that_it_shows() -> None:
    assert [name for name in _FILES if _PAGE.count(name) < 2 and not name.startswith("tests/")] == []


@pytest.mark.system
def test_its_own_test_passes(followed: Path) -> None:
    pytest_there(followed, *(name for name in _FILES if name.startswith("tests/")))


@pytest.mark.system
def test_what_holds_for_every_task_holds_for_this_one(followed: Path) -> None:
    pytest_there(followed, *_CHECKERS.split(), "-k", "two_arm_press_buttons")


def test_its_code_is_clean(followed: Path) -> None:
    for check in (["check"], ["format", "--check"]):
        subprocess.run([sys.executable, "-m", "ruff", *check, *_FILES], cwd=followed, check=True)
