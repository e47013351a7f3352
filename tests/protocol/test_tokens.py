from __future__ import annotations

import stat
import time
from dataclasses import replace
from pathlib import Path

import jwt
import pytest

from mart.protocol.errors import Forbidden, InvalidInput
from mart.protocol.tokens import Role, SeatToken, load_or_create_secret, sign, verify

SECRET = b"s" * 64
TOKEN = SeatToken("room-1", "arm0", 7, Role.PHONE, "h1", float(int(time.time()) + 600))


def test_a_signed_token_verifies_to_itself() -> None:
    assert verify(sign(TOKEN, SECRET), SECRET) == TOKEN


@pytest.mark.parametrize("text", ["", "x", "a.b.c", "x" * 5000])
def test_what_is_no_token_is_refused(text: str) -> None:
    with pytest.raises(Forbidden):
        verify(text, SECRET)


def test_another_secret_a_changed_body_and_a_missing_signature_are_refused() -> None:
    text = sign(TOKEN, SECRET)
    other_body = sign(replace(TOKEN, arm="arm1"), SECRET).split(".")[1]
    head, _, signature = text.split(".")
    unsigned = jwt.encode(
        {"room": "room-1", "arm": "arm0", "epoch": 7, "role": "phone", "sub": "h"}, "", "none"
    )
    for forged in (
        sign(TOKEN, b"t" * 64),
        f"{head}.{other_body}.{signature}",
        f"{head}.{other_body}.",
        unsigned,
    ):
        with pytest.raises(Forbidden):
            verify(forged, SECRET)


def test_an_expired_token_says_so() -> None:
    with pytest.raises(Forbidden, match="expired"):
        verify(sign(replace(TOKEN, expires_s=float(int(time.time()) - 10)), SECRET), SECRET)


def test_an_incomplete_token_is_refused() -> None:
    with pytest.raises(Forbidden):
        verify(jwt.encode({"room": "room-1", "exp": time.time() + 60}, SECRET, "HS256"), SECRET)


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
