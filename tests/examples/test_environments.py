"""The examples of environments run as they stand, in a folder of their own, without a warning."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.contract.repository import ROOT


def output_of(example: str, folder: Path) -> str:
    command = [sys.executable, "-W", "error", str(ROOT / "examples" / example)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout


def test_an_environment_is_stepped_and_seen(tmp_path: Path) -> None:
    printed = output_of("01_environment.py", tmp_path).splitlines()
    assert "actions: (2, 7)" in printed
    assert "picture: (480, 640, 3), uint8" in printed
    assert not any("cube1" in line for line in printed if line.startswith("arm0 sees"))


def test_an_expert_of_ones_own_succeeds(tmp_path: Path) -> None:
    printed = output_of("02_scripted_expert.py", tmp_path).splitlines()
    assert len(printed) == 3
    assert all("success" in line for line in printed)
