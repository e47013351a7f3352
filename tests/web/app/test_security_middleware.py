from __future__ import annotations

from collections.abc import AsyncIterator

import pytest

from mart.web.app.security_middleware import MAX_BODY_BYTES
from tests.web.conftest import JOIN_CODE, Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio

CHANGES = [
    ("POST", "/api/join"),
    ("POST", "/api/pair"),
    ("POST", "/api/rooms/room-1/seats/arm0"),
    ("DELETE", "/api/rooms/room-1/seats/arm0"),
    ("POST", "/api/rooms/room-1/episode"),
    ("POST", "/api/rooms/room-1/seats/arm0/pair"),
    ("POST", "/api/rooms/room-1/seats/arm0/offer"),
]
FOREIGN = [
    "https://evil.example",
    "http://localhost",
    "https://localhost:9",
    "https://localhost.evil.example",
    "null",
    "",
]


@pytest.mark.parametrize(("method", "path"), CHANGES)
@pytest.mark.parametrize("origin", FOREIGN)
async def test_other_sites_cannot_change_anything(
    enter: Enter, room: Room, method: str, path: str, origin: str
) -> None:
    ana = await enter("Ana")
    answer = await ana.request(method, path, json={"operator": "human"}, headers={"Origin": origin})
    assert answer.status_code == 403
    assert answer.json()["error"]["code"] == "Forbidden"
    assert not room.seats["arm0"].holder_id


async def test_a_missing_origin_is_a_foreign_one(enter: Enter) -> None:
    browser = await enter()
    del browser.headers["Origin"]
    answer = await browser.post("/api/join", json={"code": JOIN_CODE, "name": "Ana"})
    assert answer.status_code == 403


@pytest.mark.parametrize("host", ["evil.example", "localhost.evil.example", "", "[::1"])
async def test_a_rebound_name_is_refused_even_for_reading(enter: Enter, host: str) -> None:
    browser = await enter()
    answer = await browser.get("/api/health", headers={"Host": host})
    assert answer.status_code == 421
    assert "--public-host" in answer.json()["error"]["message"]


async def test_every_name_of_the_site_works_with_its_own_origin(enter: Enter) -> None:
    browser = await enter()
    headers = {"Host": "lab.example:9443", "Origin": "https://lab.example:9443"}
    answer = await browser.post("/api/join", json={"code": JOIN_CODE, "name": "Ana"}, headers=headers)
    assert answer.status_code == 200


@pytest.mark.parametrize(
    ("page", "may"),
    [
        ("/rooms/room-1/arms/arm0", True),
        ("/watch", True),
        ("/host", True),
        ("/", False),
        ("/phone", True),
        ("/episodes", False),
        ("/api/rooms", False),
        ("/watch/../episodes", False),
    ],
)
async def test_only_pages_on_which_people_talk_may_ask_for_a_microphone(
    enter: Enter, page: str, may: bool
) -> None:
    browser = await enter()
    policy = (await browser.get(page)).headers["Permissions-Policy"]
    assert ("microphone=(self)" in policy) is may
    assert ("microphone=()" in policy) is not may
    assert "camera=()" in policy


async def test_a_long_body_is_refused_unread(enter: Enter) -> None:
    browser = await enter()
    answer = await browser.post("/api/join", content=b" " * (MAX_BODY_BYTES + 1))
    assert answer.status_code == 413
    assert answer.json()["error"]["code"] == "InvalidInput"


async def test_a_body_of_untold_length_is_refused(enter: Enter) -> None:
    async def endless() -> AsyncIterator[bytes]:
        yield b"{}"

    browser = await enter()
    assert (await browser.post("/api/join", content=endless())).status_code == 413


@pytest.mark.parametrize("length", ["-1", "x", "9" * 400])
async def test_a_made_up_length_is_refused(enter: Enter, length: str) -> None:
    browser = await enter()
    answer = await browser.post("/api/join", content=b"", headers={"Content-Length": length})
    assert answer.status_code in (400, 413)


@pytest.mark.parametrize("path", ["/", "/phone", "/static/css/base.css", "/api/health", "/nowhere"])
async def test_every_answer_carries_the_headers_that_keep_pages_safe(enter: Enter, path: str) -> None:
    headers = (await (await enter()).get(path)).headers
    policy = headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "frame-ancestors 'none'" in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cache-control"] in ("no-store", "no-cache")


async def test_pages_have_no_inline_scripts_or_styles(enter: Enter) -> None:
    browser = await enter()
    for path in ("/", "/phone", "/rooms/room-1/arms/arm0", "/nowhere"):
        text = (await browser.get(path)).text
        assert "<script>" not in text
        assert "<style" not in text
        assert " style=" not in text
        assert " onclick=" not in text


async def test_an_unknown_page_says_where_to_go(enter: Enter) -> None:
    answer = await (await enter()).get("/nowhere")
    assert answer.status_code == 404
    assert "Go to the lobby" in answer.text


@pytest.mark.parametrize(
    "path", ["/api/nowhere", "/static/../cli.py", "/static/%2e%2e/cli.py", "/static/nothing.js"]
)
async def test_an_unknown_address_is_not_found(enter: Enter, path: str) -> None:
    assert (await (await enter()).get(path)).status_code == 404


async def test_the_wrong_method_is_told(enter: Enter) -> None:
    answer = await (await enter()).post("/api/me", json={})
    assert answer.status_code == 405
    assert answer.json()["error"]["code"] == "InvalidInput"
