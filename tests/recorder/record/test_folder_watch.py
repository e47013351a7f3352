"""A folder that takes nothing is noticed before a write fails; each news is told once."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace

import pytest

from mart.recorder.record.folder_watch import FolderWatch, trouble_of


def test_a_folder_with_room_has_no_trouble(tmp_path: Path) -> None:
    assert trouble_of(tmp_path) == trouble_of(tmp_path / "gone") == ""
    assert FolderWatch(tmp_path).news() is None


@pytest.mark.parametrize(("free", "flag", "word"), [(10, 0, "full"), (10**9, os.ST_RDONLY, "read-only")])
def test_what_is_wrong_is_told_once_and_so_is_its_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, free: int, flag: int, word: str
) -> None:
    watch, found = (
        FolderWatch(tmp_path),
        SimpleNamespace(f_frsize=1, f_bavail=free, f_bfree=free, f_flag=flag),
    )
    monkeypatch.setattr(os, "statvfs", lambda _: found)
    level, text = watch.news() or ("", "")
    assert (level, word in text) == ("error", True)
    assert watch.news() is None
    found.f_bavail = found.f_bfree = 10**9
    found.f_flag = 0
    assert (watch.news() or ("", ""))[0] == "info"
    assert watch.news() is None
