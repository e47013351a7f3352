"""Secrets in files: made once, whole, and private."""

from __future__ import annotations

import os
import stat
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from mart.protocol.errors import InvalidInput
from mart.runtime import secret_file
from mart.runtime.secret_file import load_or_create_secret


def test_the_secret_is_made_once_and_readable_by_its_owner_alone(tmp_path: Path) -> None:
    path = tmp_path / "secrets" / "seat-token"
    secret = load_or_create_secret(path)
    assert load_or_create_secret(path) == secret
    assert len(secret) == 64
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700


def test_all_who_ask_at_once_get_the_same(tmp_path: Path) -> None:
    path = tmp_path / "bus"
    with ThreadPoolExecutor(8) as pool:
        assert len(set(pool.map(load_or_create_secret, [path] * 32))) == 1
    assert [file.name for file in tmp_path.iterdir()] == ["bus"]


def test_a_crash_while_it_is_made_leaves_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(OSError, match="No space"):
        load_or_create_secret(tmp_path / "bus")
    assert list(tmp_path.iterdir()) == []
    monkeypatch.undo()
    assert load_or_create_secret(tmp_path / "bus")


def test_a_short_secret_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "seat-token"
    path.write_text("abc")
    path.chmod(0o600)
    with pytest.raises(InvalidInput, match="delete the file"):
        load_or_create_secret(path)


@pytest.mark.parametrize("mode", [0o644, 0o640, 0o604])
def test_a_secret_that_others_can_read_is_refused(tmp_path: Path, mode: int) -> None:
    path = tmp_path / "seat-token"
    secret_file.load_or_create_secret(path)
    path.chmod(mode)
    with pytest.raises(InvalidInput, match="chmod 600"):
        load_or_create_secret(path)
