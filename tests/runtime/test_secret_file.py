"""The secret that signs seat tokens."""

from __future__ import annotations

import stat
from pathlib import Path

import pytest

from mart.protocol.errors import InvalidInput
from mart.runtime.secret_file import load_or_create_secret


def test_the_secret_is_made_once_and_readable_by_its_owner_alone(tmp_path: Path) -> None:
    path = tmp_path / "secrets" / "seat-token"
    secret = load_or_create_secret(path)
    assert load_or_create_secret(path) == secret
    assert len(secret) == 64
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


def test_a_short_secret_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "seat-token"
    path.write_text("abc")
    with pytest.raises(InvalidInput, match="delete the file"):
        load_or_create_secret(path)
