"""The example of an episode runs as it stands, in a folder of its own, without a warning."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mart.episodes import LabelKind, labels
from mart.sim.world import World
from tests.contract.repository import ROOT
from tests.trainer import recorded


def output_of(folder: Path, *arguments: object) -> list[str]:
    command = [sys.executable, "-W", "error", ROOT / "examples" / "03_read_an_episode.py", *arguments]
    ran = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True, check=True)
    return ran.stdout.splitlines()


@pytest.fixture
def path(tmp_path: Path) -> Path:
    world = World.build(recorded.TASK)
    return recorded.write(tmp_path / "data" / "episodes", world, recorded.perform(world, 1)[:12])


def test_an_episode_is_read_as_a_file_and_as_the_newest_one(path: Path, tmp_path: Path) -> None:
    labels.say(path, LabelKind.OUTCOME, "failure", 1)
    printed = output_of(tmp_path, path)
    assert printed == output_of(tmp_path)
    assert printed[0].startswith(f"{path.name}: failure")
    assert "arm1 was driven by script expert" in printed
    assert "actions: (11, 2, 7), of arm0, arm1" in printed
    assert "arm0/tool_position_in_base: (12, 3)" in printed


def test_an_episode_that_was_dropped_is_not_the_newest_one(path: Path, tmp_path: Path) -> None:
    labels.say(path, LabelKind.USE, labels.DROP, 1)
    with pytest.raises(subprocess.CalledProcessError) as failed:
        output_of(tmp_path)
    assert "no episodes" in failed.value.stderr
