from __future__ import annotations

import asyncio

import pytest

from mart.web.api.app_state import AppState
from tests.web.conftest import JOIN_CODE, Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio


@pytest.fixture
def held_back(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """How long each try to join was held back, seconds; nobody waits for it here."""
    waits_s: list[float] = []
    sleep = asyncio.sleep

    async def note(delay_s: float) -> None:
        waits_s.append(delay_s)
        await sleep(0)

    monkeypatch.setattr("mart.web.api.auth.asyncio.sleep", note)
    return waits_s


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
    assert after == {"holder_id": before["holder_id"], "name": "Anna", "hosts": False, "passed_course": False}


async def test_a_wrong_code_is_refused_in_words(enter: Enter) -> None:
    browser = await enter()
    answer = await browser.post("/api/join", json={"code": "WRONG-99", "name": "Ana"})
    assert answer.status_code == 403
    assert answer.json()["error"]["code"] == "Forbidden"
    assert (await browser.get("/api/me")).status_code == 401


WRONG = {"code": "WRONG-99", "name": "X"}
RIGHT = {"code": JOIN_CODE, "name": "Ben"}


async def test_the_right_code_works_however_many_wrong_ones_came_from_the_same_address(
    enter: Enter, held_back: list[float]
) -> None:
    guesser, neighbour = await enter(), await enter()
    for _ in range(20):
        assert (await guesser.post("/api/join", json=WRONG)).status_code == 403
    assert (await neighbour.post("/api/join", json=RIGHT)).status_code == 200
    assert held_back[:6] == [0.0] * 6
    assert held_back[-1] == pytest.approx(1.5)


async def test_nobody_else_waits_for_a_guesser(enter: Enter, held_back: list[float]) -> None:
    joined = await enter("Ana")
    guesser, elsewhere = await enter(), await enter(address="10.0.0.2")
    for _ in range(20):
        await guesser.post("/api/join", json=WRONG)
    held_back.clear()
    assert (await joined.post("/api/join", json=RIGHT)).status_code == 200
    assert (await elsewhere.post("/api/join", json=RIGHT)).status_code == 200
    assert held_back == [0.0]


async def test_people_who_join_are_limited_and_those_who_have_joined_are_not(enter: Enter) -> None:
    ana = await enter("Ana")
    codes = [(await (await enter()).post("/api/join", json=RIGHT)).status_code for _ in range(201)]
    assert codes == [*[200] * 199, 429, 429]
    assert (await ana.post("/api/join", json=RIGHT)).status_code == 200


async def test_who_leaves_is_a_stranger_and_their_seat_is_free(enter: Enter, room: Room) -> None:
    ana = await enter("Ana")
    await ana.post("/api/rooms/room-1/seats/arm0", json={"operator": "human"})
    kept = dict(ana.cookies)
    gone = await ana.delete("/api/me")
    assert (gone.status_code, gone.json()["name"]) == (200, "Ana")
    assert not ana.cookies
    ana.cookies.update(kept)
    assert (await ana.get("/api/me")).status_code == 401
    assert not room.seats["arm0"].holder_id


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
