from __future__ import annotations

import asyncio
import json

import pytest

from mart.protocol import clock, codec, keys
from mart.protocol.messages import Answer, Offer
from mart.protocol.tokens import Role, SeatToken, sign
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Request
from mart.runtime.bus.memory import MemoryBus
from mart.runtime.ice_servers import IceSettings
from mart.web.api.app_state import AppState
from mart.web.api.dependencies import now_unix_s
from tests.web.conftest import JOIN_CODE, Enter

pytestmark = pytest.mark.anyio

SDP = "v=0\r\n"


@pytest.fixture
async def offers(bus: MemoryBus) -> list[str]:
    """What a gateway was offered to try."""
    heard: list[str] = []

    def answer(request: Request) -> None:
        heard.append(codec.decode(Offer, request.payload).sdp)
        request.reply(codec.encode(Answer(sdp="answer")))

    bus.announce(keys.alive(ServiceKind.GATEWAY, "gateway-1"))
    bus.serve(keys.connection_check("gateway-1"), answer)
    await asyncio.sleep(0)
    return heard


async def test_the_time_is_for_everybody(enter: Enter) -> None:
    told = (await (await enter()).get("/api/check")).json()
    assert abs(told["unix_s"] - now_unix_s()) < 60
    assert told["certificate_days"] > 300


async def test_nothing_that_costs_is_done_for_strangers(enter: Enter, offers: list[str]) -> None:
    stranger = await enter()
    for path, body in (("servers", {}), ("offer", {"sdp": SDP})):
        assert (await stranger.post(f"/api/check/{path}", json=body)).status_code == 401
        wrong = await stranger.post(f"/api/check/{path}", json={**body, "code": "WRONG-CODE"})
        assert wrong.status_code == 403
        forged = await stranger.post(f"/api/check/{path}", json=body, headers={"Authorization": "Bearer x.y"})
        assert forged.status_code == 403
    assert offers == []


async def test_wrong_codes_are_counted_with_those_of_the_lobby(enter: Enter, app_state: AppState) -> None:
    stranger = await enter()
    for _ in range(6):
        await stranger.post("/api/check/servers", json={"code": "WRONG-CODE"})
    assert app_state.wrong_codes.delay_s("10.0.0.1", clock.monotonic_s()) > 0.0


async def test_whoever_may_come_in_may_try_the_way(
    enter: Enter, offers: list[str], app_state: AppState
) -> None:
    ana, stranger = await enter("Ana"), await enter()
    token = sign(SeatToken("room-1", "arm0", 1, Role.PHONE, "h", now_unix_s() + 60), app_state.secret)
    asked = [
        await ana.post("/api/check/offer", json={"sdp": SDP}),
        await stranger.post("/api/check/offer", json={"sdp": SDP, "code": JOIN_CODE}),
        await stranger.post(
            "/api/check/offer", json={"sdp": SDP}, headers={"Authorization": f"Bearer {token}"}
        ),
    ]
    assert [answer.json() for answer in asked] == [{"sdp": "answer"}] * 3
    assert offers == [SDP] * 3


async def test_relays_are_named_to_whoever_may_come_in(enter: Enter, app_state: AppState) -> None:
    servers = IceSettings(
        ice_servers=json.dumps([{"urls": "turn:a.b", "username": "mart", "credential": "north"}])
    )
    object.__setattr__(app_state, "ice", servers)
    told = (await (await enter("Ana")).post("/api/check/servers", json={})).json()
    assert told["ice_servers"][0]["urls"] == "turn:a.b"


async def test_without_a_gateway_the_way_leads_nowhere(enter: Enter) -> None:
    answer = await (await enter("Ana")).post("/api/check/offer", json={"sdp": SDP})
    assert answer.status_code == 503
