"""Rules about the pages' files, and the tools that check them, that eslint and tsc do not hold."""

from __future__ import annotations

import json
import re
from typing import Any

from tests.contract.repository import ROOT, relative, tracked_files

_LONGEST_STYLE_SHEET_LINES = 300


def _packages() -> dict[str, dict[str, Any]]:
    """Every package that the lock file pins, by its folder, the project's own entry left out."""
    packages: dict[str, dict[str, Any]] = json.loads((ROOT / "package-lock.json").read_text())["packages"]
    return {folder: package for folder, package in packages.items() if folder}


def test_style_sheets_stay_short() -> None:
    sheets = [path for path in tracked_files() if path.suffix == ".css"]
    lengths = {relative(path): len(path.read_text().splitlines()) for path in sheets}
    assert sheets
    assert {name: lines for name, lines in lengths.items() if lines > _LONGEST_STYLE_SHEET_LINES} == {}


def test_tools_are_pinned_exactly() -> None:
    wanted: dict[str, str] = json.loads((ROOT / "package.json").read_text())["devDependencies"]
    assert [name for name, version in wanted.items() if not re.fullmatch(r"\d+\.\d+\.\d+", version)] == []
    assert {name: _packages()[f"node_modules/{name}"]["version"] for name in wanted} == wanted


def test_the_lock_file_names_digests_and_never_places() -> None:
    assert [folder for folder, package in _packages().items() if "resolved" in package] == []
    assert [folder for folder, package in _packages().items() if "integrity" not in package] == []
