"""STUN and TURN servers: what may be given, with which credentials they are asked, and what they are asked."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import hashlib
import hmac
import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput, Unavailable
from mart.runtime.ice_check import check_ice_server
from mart.runtime.ice_servers import (
    CREDENTIAL_LIFETIME_S,
    IceServer,
    IceSettings,
    parse_ice_servers,
)
from tests.support.turn_server import silent_server, turn_server

NOW_UNIX_S = 1_800_000_000.0


def test_urls_and_objects_are_read_as_browsers_take_them() -> None:
    given = ["stun:a.org", {"urls": ["turn:b.org:3479", "turns:c.org"], "username": "u", "credential": "c"}]
    servers = parse_ice_servers(given)
    assert servers == (
        IceServer("stun:a.org"),
        IceServer("turn:b.org:3479", "u", "c"),
        IceServer("turns:c.org", "u", "c"),
    )
    assert [server.address for server in servers] == [("a.org", 3478), ("b.org", 3479), ("c.org", 5349)]
    assert [server.transport for server in servers] == ["udp", "udp", "tcp"]
    assert [server.as_json() for server in servers[:2]] == [
        {"urls": "stun:a.org"},
        {"urls": "turn:b.org:3479", "username": "u", "credential": "c"},
    ]


@pytest.mark.parametrize(
    "given",
    [
        "stun:a.org",
        "{",
        "3",
        '{"urls": "stun:a.org"}',
        "[3]",
        '["http://a.org"]',
        '["stun:a.org:99999"]',
        '["stun:a.org?transport=udp"]',
        '["turns:b.org?transport=udp"]',
        '["turn:[::1]"]',
        '["turn:b.org"]',
        '["turn:user:secret@b.org"]',
        '[{"urls": "turn:b.org", "username": "u"}]',
        '[{"urls": "turn:b.org", "username": "u", "credential": 3}]',
        '[{"urls": "turn:b.org", "user": "u"}]',
        '[{"username": "u", "credential": "c"}]',
        json.dumps(["stun:a.org"] * 9),
    ],
)
def test_what_cannot_be_used_is_blamed_on_the_setting(given: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MART_ICE_SERVERS", given)
    with pytest.raises(InvalidInput) as refused:
        IceSettings()
    assert "MART_ICE_SERVERS" in str(refused.value)
    assert "secret" not in str(refused.value).replace("its secret in MART_TURN_SECRET", "")


@settings(max_examples=50)
@given(
    st.recursive(
        st.text() | st.integers() | st.none(),
        lambda inner: (
            st.lists(inner) | st.dictionaries(st.sampled_from(["urls", "username", "credential", "x"]), inner)
        ),
    )
)
def test_nothing_but_a_sentence_comes_of_nonsense(given: object) -> None:
    with contextlib.suppress(InvalidInput):
        for server in parse_ice_servers(given):
            assert server.address[1] > 0


def test_a_secret_gives_credentials_that_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MART_ICE_SERVERS", '["stun:a.org", "turn:b.org"]')
    monkeypatch.setenv("MART_TURN_SECRET", "north")
    settings = IceSettings()
    assert "north" not in repr(settings)
    stun, relay = settings.ice_servers_at(NOW_UNIX_S)
    assert stun == IceServer("stun:a.org")
    assert relay.username == f"{int(NOW_UNIX_S + CREDENTIAL_LIFETIME_S)}:mart"
    digest = hmac.new(b"north", relay.username.encode(), hashlib.sha1).digest()
    assert relay.credential == base64.b64encode(digest).decode()


def test_a_server_is_asked_with_its_credentials() -> None:
    async def ask() -> None:
        async with turn_server("mart", "north") as (server, port):
            assert "relays at 127.0.0.1" in await check_ice_server(
                IceServer(f"turn:127.0.0.1:{port}", "mart", "north")
            )
            assert server.asked[-1][1] == "mart"
            assert "sees us at 127.0.0.1" in await check_ice_server(IceServer(f"stun:127.0.0.1:{port}"))
            for credentials in (("mart", "south"), ("ana", "north")):
                with pytest.raises(Unavailable, match="refuses the credentials"):
                    await check_ice_server(IceServer(f"turn:127.0.0.1:{port}", *credentials))

    asyncio.run(ask())


@pytest.mark.parametrize("scheme", ["stun", "turn"])
def test_a_silent_server_is_waited_for_only_so_long(scheme: str) -> None:
    async def ask() -> None:
        async with silent_server() as port:
            with pytest.raises(Unavailable, match="does not answer within"):
                await check_ice_server(
                    IceServer(f"{scheme}:127.0.0.1:{port}", "mart", "north"), timeout_s=0.1
                )
        with pytest.raises(Unavailable, match="cannot be reached"):
            await check_ice_server(IceServer(f"{scheme}:nowhere.invalid", "mart", "north"))

    asyncio.run(ask())
