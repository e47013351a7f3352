"""A phone pairs over HTTP as docs/protocol.md says, and passes on what a lobby answers."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable

import httpx
import pytest

from mart.protocol.errors import Forbidden, MartError, Unavailable
from mart.teleop_gateway.phones.pairing_client import PairingClient, PhonePairing

URL = "https://127.0.0.1:8443"
PAIRING = PhonePairing(token="t0ken", room="room-1", arm="arm0", epoch=3, name="Ana")


def ask(answer: Callable[[httpx.Request], httpx.Response], code: str = "ABC123") -> tuple[PhonePairing, str]:
    """Pairs and offers, with `answer` in the lobby's place."""

    async def run() -> tuple[PhonePairing, str]:
        async with PairingClient(URL, insecure=True, transport=httpx.MockTransport(answer)) as lobby:
            pairing = await lobby.pair(code)
            return pairing, await lobby.offer(pairing, "offer")

    return asyncio.run(run())


def test_pairing_and_offering() -> None:
    def lobby(request: httpx.Request) -> httpx.Response:
        assert request.headers["origin"] == URL
        body = json.loads(request.content)
        if request.url.path == "/api/pair":
            assert body == {"code": "ABC123"}
            return httpx.Response(200, json={**vars(PAIRING), "role": "phone"})
        assert request.url.path == "/api/rooms/room-1/seats/arm0/offer"
        assert request.headers["authorization"] == "Bearer t0ken"
        assert body == {"sdp": "offer"}
        return httpx.Response(200, json={"sdp": "answer"})

    assert ask(lobby) == (PAIRING, "answer")


@pytest.mark.parametrize(("told", "arm"), [({}, "arm0"), ({"arm": "arm1"}, "arm1")])
def test_a_pairing_is_renewed_for_the_seat_where_its_person_is_now(told: dict[str, str], arm: str) -> None:
    def lobby(request: httpx.Request) -> httpx.Response:
        assert (request.method, request.url.path) == ("GET", "/api/rooms/room-1/seats/arm0/phone-token")
        assert request.headers["authorization"] == "Bearer t0ken"
        return httpx.Response(200, json={"token": "newer", "epoch": 5, **told})

    async def run() -> PhonePairing:
        async with PairingClient(URL, insecure=True, transport=httpx.MockTransport(lobby)) as client:
            return await client.renew(PAIRING)

    assert asyncio.run(run()) == PhonePairing("newer", "room-1", arm, 5, "Ana")


def test_a_refusal_is_passed_on() -> None:
    error = {"error": {"code": "Forbidden", "message": "This code was used already."}}
    with pytest.raises(Forbidden, match="used already"):
        ask(lambda _: httpx.Response(403, json=error))


@pytest.mark.parametrize(
    "response",
    [
        httpx.Response(502, text="<html>bad gateway</html>"),
        httpx.Response(200, json=["what?"]),
        httpx.Response(200, json={"token": "t"}),
        httpx.Response(500, json={"error": "oops"}),
    ],
    ids=["no JSON", "no object", "incomplete", "no error object"],
)
def test_what_is_no_lobby_is_said_so(response: httpx.Response) -> None:
    with pytest.raises(Unavailable, match="does not answer as a lobby"):
        ask(lambda _: response)


def test_nobody_there() -> None:
    async def run() -> None:
        async with PairingClient("https://127.0.0.1:9", insecure=True) as lobby:
            await lobby.pair("ABC123")

    with pytest.raises(MartError, match=r"127\.0\.0\.1:9"):
        asyncio.run(run())
