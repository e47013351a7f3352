"""Rules about the pages' files that eslint and tsc do not hold."""

from __future__ import annotations

from tests.contract.repository import relative, tracked_files

_LONGEST_STYLE_SHEET_LINES = 300


def test_style_sheets_stay_short() -> None:
    sheets = [path for path in tracked_files() if path.suffix == ".css"]
    lengths = {relative(path): len(path.read_text().splitlines()) for path in sheets}
    assert sheets
    assert {name: lines for name, lines in lengths.items() if lines > _LONGEST_STYLE_SHEET_LINES} == {}
