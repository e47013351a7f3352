from __future__ import annotations

import pytest

from mart.web.api.app_state import AppState
from tests.web.conftest import JOIN_CODE, Enter

pytestmark = pytest.mark.anyio


async def test_who_joins_is_known_afterwards(enter: Enter) -> None:
    ana = await enter("Ana")
    assert (await ana.get("/api/me")).json()["name"] == "Ana"


async def test_the_session_cookie_is_for_this_site_and_not_for_scripts(enter: Enter) -> None:
    browser = await enter()
    answer = await browser.post("/api/join", json={"code": JOIN_CODE, "name": "Ana"})
    cookie = answer.headers["set-cookie"]
    assert cookie.startswith("__Host-")
    assert all(part in cookie for part in ("HttpOnly", "Secure", "SameSite=strict", "Path=/"))


async def test_case_and_dashes_of_the_code_do_not_matter(enter: Enter) -> None:
    browser = await enter()
    answer = await browser.post("/api/join", json={"code": " abcd 2345", "name": "Ana"})
    assert answer.status_code == 200


async def test_joining_again_keeps_the_person_and_changes_the_name(enter: Enter) -> None:
    ana = await enter("Ana")
    before = (await ana.get("/api/me")).json()
    await ana.post("/api/join", json={"code": JOIN_CODE, "name": "Anna"})
    after = (await ana.get("/api/me")).json()
    assert after == {"holder_id": before["holder_id"], "name": "Anna"}


async def test_a_wrong_code_is_refused_in_words(enter: Enter) -> None:
    browser = await enter()
    answer = await browser.post("/api/join", json={"code": "WRONG-99", "name": "Ana"})
    assert answer.status_code == 403
    assert answer.json()["error"]["code"] == "Forbidden"
    assert (await browser.get("/api/me")).status_code == 401


async def test_after_five_wrong_codes_even_the_right_one_has_to_wait(enter: Enter) -> None:
    guesser = await enter()
    for _ in range(5):
        assert (await guesser.post("/api/join", json={"code": "WRONG-99", "name": "X"})).status_code == 403
    locked = await guesser.post("/api/join", json={"code": JOIN_CODE, "name": "X"})
    assert locked.status_code == 429
    assert int(locked.headers["retry-after"]) > 0
    assert locked.json()["error"]["code"] == "TooMany"


async def test_the_right_code_makes_wrong_ones_before_it_forgotten(enter: Enter) -> None:
    browser = await enter()
    codes = (*["WRONG-99"] * 4, JOIN_CODE, *["WRONG-99"] * 5, JOIN_CODE)
    answers = [await browser.post("/api/join", json={"code": code, "name": "X"}) for code in codes]
    assert [answer.status_code for answer in answers] == [*[403] * 4, 200, *[403] * 5, 429]


async def test_the_lock_is_for_one_address_only(enter: Enter) -> None:
    guesser = await enter()
    for _ in range(6):
        await guesser.post("/api/join", json={"code": "WRONG-99", "name": "X"})
    neighbour = await enter(address="10.0.0.2")
    answer = await neighbour.post("/api/join", json={"code": JOIN_CODE, "name": "Ben"})
    assert answer.status_code == 200


@pytest.mark.parametrize("name", ["", "   ", "\x00\n", "a" * 33])
async def test_a_name_has_1_to_32_characters(enter: Enter, name: str) -> None:
    browser = await enter()
    answer = await browser.post("/api/join", json={"code": JOIN_CODE, "name": name})
    assert answer.status_code == 400
    assert answer.json()["error"]["code"] == "InvalidInput"


@pytest.mark.parametrize(
    "body", [b"", b"{", b"[]", b'{"code": 1, "name": "A"}', b'{"name": "A"}', b"\xff\xfe"]
)
async def test_a_body_that_is_no_join_is_a_bad_request_in_words(enter: Enter, body: bytes) -> None:
    browser = await enter()
    answer = await browser.post("/api/join", content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code == 400
    assert answer.json()["error"]["code"] == "InvalidInput"


@pytest.mark.parametrize("path", ["/api/me", "/api/rooms", "/api/rooms/room-1/seats/arm0/token"])
async def test_strangers_see_nothing(enter: Enter, path: str) -> None:
    stranger = await enter()
    assert (await stranger.get(path)).status_code == 401


async def test_a_made_up_session_is_no_session(enter: Enter, app_state: AppState) -> None:
    stranger = await enter()
    stranger.cookies.set("__Host-mart-session", "A" * 43)
    assert (await stranger.get("/api/rooms")).status_code == 401
