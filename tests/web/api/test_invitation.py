from __future__ import annotations

import pytest

from mart.web.api.app_state import AppState
from tests.web.conftest import JOIN_CODE, Enter

pytestmark = pytest.mark.anyio


async def test_whoever_is_in_shows_others_the_way(enter: Enter, app_state: AppState) -> None:
    app_state.site.mdns_host = "mart.local"
    told = (await (await enter("Ana")).get("/api/invitation")).json()
    assert told["url"] == "https://192.168.1.5/"
    assert told["other_urls"] == ["https://mart.local/"]
    assert told["code"] == JOIN_CODE
    assert "<svg" in told["qr_svg"]
    assert told["hint"] == ""


async def test_where_nobody_else_gets_to_it_says_so(enter: Enter, app_state: AppState) -> None:
    app_state.site.lan_host = ""
    told = (await (await enter("Ana")).get("/api/invitation")).json()
    assert told["other_urls"] == []
    assert "--host" in told["hint"]


async def test_strangers_are_not_told_the_code(enter: Enter) -> None:
    assert (await (await enter()).get("/api/invitation")).status_code == 401


async def test_this_machine_alone_is_told_the_addresses_with_the_health(enter: Enter) -> None:
    here = await enter(address="127.0.0.1")
    assert (await here.get("/api/health")).json()["urls"] == ["https://192.168.1.5/"]
    elsewhere = await enter(address="10.0.0.7")
    assert "urls" not in (await elsewhere.get("/api/health")).json()
