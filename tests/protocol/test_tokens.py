from __future__ import annotations

import time
from dataclasses import replace

import jwt
import pytest

from mart.protocol.errors import Forbidden
from mart.protocol.tokens import Role, SeatToken, sign, verify

SECRET = b"s" * 64
TOKEN = SeatToken("room-1", "arm0", 7, Role.PHONE, "h1", float(int(time.time()) + 600))


def test_a_signed_token_verifies_to_itself() -> None:
    assert verify(sign(TOKEN, SECRET), SECRET) == TOKEN
    named = replace(TOKEN, speaks_as="Ana")
    assert verify(sign(named, SECRET), SECRET) == named


def test_a_token_that_says_nothing_of_it_gives_no_voice() -> None:
    claims = jwt.decode(sign(replace(TOKEN, speaks_as="Ana"), SECRET), SECRET, algorithms=["HS256"])
    del claims["speaks_as"]
    assert verify(jwt.encode(claims, SECRET, "HS256"), SECRET).speaks_as == ""


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
