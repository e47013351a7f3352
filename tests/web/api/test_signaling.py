from __future__ import annotations

import asyncio
from dataclasses import replace
from typing import Any

import pytest

from mart.protocol import clock, codec, keys
from mart.protocol.errors import Conflict
from mart.protocol.messages import Answer, Offer, OpenSeat, OpenSeatReply, error_message
from mart.protocol.tokens import Role, SeatToken, sign, verify
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Request
from mart.runtime.bus.memory import MemoryBus
from mart.runtime.ice_servers import IceSettings
from mart.web.api.app_state import AppState
from tests.web.conftest import HOST_CODE, Client, Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio

SEAT = "/api/rooms/room-1/seats/arm0"
SDP = "v=0\r\n"


class Gateway:
    """Answers offers on the bus; what it was asked is in `opened` and `offers`."""

    def __init__(self, bus: MemoryBus, roles: tuple[str, ...] = ("browser", "phone", "viewer")) -> None:
        self.opened: list[OpenSeat] = []
        self.offers: list[Offer] = []
        self.refusal: Conflict | None = None
        self.alive = bus.announce(keys.alive(ServiceKind.GATEWAY, "gateway-1"))
        bus.serve(keys.open_seat("gateway-1"), self._open)
        for role in roles:
            bus.serve(keys.signal("room-1", "arm0", role), self._answer)

    def _open(self, request: Request) -> None:
        self.opened.append(codec.decode(OpenSeat, request.payload))
        reply = OpenSeatReply(error=error_message(self.refusal)) if self.refusal else OpenSeatReply()
        request.reply(codec.encode(reply))

    def _answer(self, request: Request) -> None:
        self.offers.append(codec.decode(Offer, request.payload))
        request.reply(codec.encode(Answer(sdp="answer")))


@pytest.fixture
async def gateway(bus: MemoryBus, room: Room) -> Gateway:
    gateway = Gateway(bus)
    await asyncio.sleep(0)
    return gateway


async def seated(enter: Enter, name: str = "Ana") -> Client:
    person = await enter(name)
    assert (await person.post(SEAT, json={"operator": "human"})).status_code == 200
    return person


async def offer(client: Client, token: str, path: str = SEAT) -> tuple[int, dict[str, str]]:
    answer = await client.post(
        f"{path}/offer", json={"sdp": SDP}, headers={"Authorization": f"Bearer {token}"}
    )
    return answer.status_code, answer.json().get("error", {})


async def test_the_holder_drives_and_others_watch(enter: Enter, room: Room, app_state: AppState) -> None:
    ana, ben = await seated(enter), await enter("Ben")
    for person, role in ((ana, Role.BROWSER), (ben, Role.VIEWER)):
        told = (await person.get(f"{SEAT}/token")).json()
        token = verify(told["token"], app_state.secret)
        assert (told["role"], token.role) == (role.value, role)
        assert told["epoch"] == token.epoch == room.seats["arm0"].epoch


async def test_the_holder_and_a_host_may_speak_and_another_guest_only_hears(
    enter: Enter, room: Room, app_state: AppState
) -> None:
    ana, ben, hanna = await seated(enter), await enter("Ben"), await enter("Hanna")
    assert (await hanna.post("/api/host", json={"code": HOST_CODE})).status_code == 200
    told = dict[str, str]()
    for person, speaks_as in ((ana, "Ana"), (ben, ""), (hanna, "Hanna")):
        told = (await person.get(f"{SEAT}/token")).json()
        assert verify(told["token"], app_state.secret).speaks_as == speaks_as
        assert told["speaks_as"] == speaks_as
    told = (await hanna.get(f"{SEAT}/token")).json()
    claims = verify(told["token"], app_state.secret)  # whoever hosts no more soon speaks no more
    assert claims.expires_s < clock.wall_ns() * 1e-9 + 30
    assert (await hanna.delete("/api/me")).status_code == 200
    assert (await hanna.get(f"{SEAT}/token")).status_code == 401


async def test_an_offer_reaches_the_gateway_and_its_answer_comes_back(enter: Enter, gateway: Gateway) -> None:
    ana = await seated(enter)
    told = (await ana.get(f"{SEAT}/token")).json()
    answer = await ana.post(
        f"{SEAT}/offer", json={"sdp": SDP}, headers={"Authorization": f"Bearer {told['token']}"}
    )
    assert answer.json() == {"sdp": "answer"}
    assert [(asked.room, asked.arm, asked.seat_epoch) for asked in gateway.opened] == [
        ("room-1", "arm0", told["epoch"])
    ]
    assert [(made.sdp, made.token) for made in gateway.offers] == [(SDP, told["token"])]


async def test_a_page_needs_no_token_and_is_told_what_one_would_tell(
    enter: Enter, gateway: Gateway, app_state: AppState
) -> None:
    ana, ben = await seated(enter), await enter("Ben")
    for person, role in ((ana, Role.BROWSER), (ben, Role.VIEWER)):
        told = (await person.get(f"{SEAT}/token")).json()
        answer = (await person.post(f"{SEAT}/offer", json={"sdp": SDP})).json()
        signed = verify(gateway.offers[-1].token, app_state.secret)
        assert (signed.role, signed.epoch) == (role, told["epoch"])
        assert answer == {"sdp": "answer"} | {
            key: told[key] for key in ("role", "epoch", "speaks_as", "ice_servers")
        }


async def test_a_page_at_a_seat_without_a_picture_is_told_at_once(enter: Enter, gateway: Gateway) -> None:
    answer = await (await enter("Ana")).post(f"{SEAT}/offer", json={"sdp": SDP})
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "Conflict")
    assert gateway.opened == []


async def test_an_offer_without_a_seat_token_or_a_visit_is_refused(enter: Enter, gateway: Gateway) -> None:
    ana = await seated(enter)
    answer = await (await enter()).post(f"{SEAT}/offer", json={"sdp": SDP})
    assert answer.status_code == 401
    for token in ("", "garbage", "a.b.c", "x" * 5000):
        assert (await offer(ana, token))[0] == 403
    assert gateway.opened == []


async def test_a_token_opens_its_own_seat_only(enter: Enter, gateway: Gateway, app_state: AppState) -> None:
    ana = await seated(enter)
    token = (await ana.get(f"{SEAT}/token")).json()["token"]
    status, error = await offer(ana, token, "/api/rooms/room-1/seats/arm1")
    assert (status, error["code"]) == (403, "Forbidden")
    forged = sign(SeatToken("room-1", "arm0", 2, Role.BROWSER, "me", 2e9), b"x" * 32)
    expired = sign(SeatToken("room-1", "arm0", 2, Role.BROWSER, "me", 1.0), app_state.secret)
    for bad in (forged, expired):
        assert (await offer(ana, bad))[0] == 403
    assert gateway.offers == []


async def test_a_token_ends_with_its_seat(enter: Enter, gateway: Gateway) -> None:
    ana = await seated(enter)
    token = (await ana.get(f"{SEAT}/token")).json()["token"]
    await ana.delete(SEAT)
    status, error = await offer(ana, token)
    assert (status, error["code"]) == (403, "Forbidden")


async def test_too_many_offers_have_to_wait(enter: Enter, gateway: Gateway) -> None:
    ana = await seated(enter)
    token = (await ana.get(f"{SEAT}/token")).json()["token"]
    statuses = [(await offer(ana, token))[0] for _ in range(31)]
    assert statuses == [200] * 30 + [429]


async def test_without_a_gateway_the_page_is_told_what_to_start(enter: Enter, room: Room) -> None:
    ana = await seated(enter)
    status, error = await offer(ana, (await ana.get(f"{SEAT}/token")).json()["token"])
    assert status == 503
    assert "mart gateway" in error["message"]


async def test_a_gateway_that_is_away_for_a_moment_is_awaited(
    enter: Enter, gateway: Gateway, bus: MemoryBus
) -> None:
    """Its link broke, or the router was started anew: it is there again within seconds, and the page need not ask."""
    ana = await seated(enter)
    token = (await ana.get(f"{SEAT}/token")).json()["token"]
    gateway.alive.close()
    await asyncio.sleep(0)  # the site has heard of it
    asyncio.get_running_loop().call_later(0.1, bus.announce, keys.alive(ServiceKind.GATEWAY, "gateway-1"))
    assert (await offer(ana, token))[0] == 200


async def test_what_the_gateway_reports_reaches_the_page(enter: Enter, gateway: Gateway) -> None:
    gateway.refusal = Conflict("All 4 processes of this gateway are in use.")
    ana = await seated(enter)
    status, error = await offer(ana, (await ana.get(f"{SEAT}/token")).json()["token"])
    assert (status, error["message"]) == (409, "All 4 processes of this gateway are in use.")


async def test_a_phone_is_paired_once_and_drives(enter: Enter, gateway: Gateway, app_state: AppState) -> None:
    ana, phone = await seated(enter), await enter()
    pairing = (await ana.post(f"{SEAT}/pair")).json()
    assert pairing["url"] == f"https://192.168.1.5/phone#{pairing['code']}"
    assert pairing["qr_svg"].startswith("<svg")
    paired = await phone.post("/api/pair", json={"code": pairing["code"]})
    told = paired.json()
    assert (told["room"], told["arm"], told["name"], told["role"]) == ("room-1", "arm0", "Ana", "phone")
    signed = verify(told["token"], app_state.secret)
    assert (signed.role, signed.speaks_as, told["speaks_as"]) == (Role.PHONE, "Ana", "Ana")
    assert (await offer(phone, told["token"]))[0] == 200
    again = await phone.post("/api/pair", json={"code": pairing["code"]})
    assert again.status_code == 403
    assert again.json()["error"]["code"] == "Forbidden"


async def renewed(phone: Client, token: str, seat: str = SEAT) -> tuple[int, dict[str, Any]]:
    answer = await phone.get(f"{seat}/phone-token", headers={"Authorization": f"Bearer {token}"})
    return answer.status_code, answer.json()


async def phone_of(person: Client, phone: Client) -> str:
    code = (await person.post(f"{SEAT}/pair")).json()["code"]
    return str((await phone.post("/api/pair", json={"code": code})).json()["token"])


async def test_a_phone_goes_on_when_its_person_takes_the_seat_back(
    enter: Enter, gateway: Gateway, room: Room, app_state: AppState
) -> None:
    ana, phone = await enter("Ana"), await enter()
    await ana.post(SEAT, json={"operator": "policy", "policy": "lifter"})
    await ana.post(SEAT, json={"operator": "human"})
    token = await phone_of(ana, phone)
    await ana.post(f"{SEAT}/hand-back")
    status, told = await renewed(phone, token)
    assert (status, told["error"]["code"]) == (409, "Conflict")
    assert "lifter" in told["error"]["message"]
    assert (await offer(phone, token))[0] == 403
    await ana.post(SEAT, json={"operator": "human"})
    assert (await offer(phone, token))[0] == 403  # the gateway and the sim know this epoch, not the old one
    status, told = await renewed(phone, token)
    assert (status, told["epoch"]) == (200, room.seats["arm0"].epoch)
    assert (await offer(phone, told["token"]))[0] == 200
    before, after = verify(token, app_state.secret), verify(told["token"], app_state.secret)
    assert after == replace(before, epoch=after.epoch)  # no longer, no more rights


async def test_a_phone_drives_for_nobody_but_its_person(
    enter: Enter, gateway: Gateway, app_state: AppState
) -> None:
    ana, ben, phone = await seated(enter), await enter("Ben"), await enter()
    token = await phone_of(ana, phone)
    assert (await renewed(phone, token, "/api/rooms/room-1/seats/arm1"))[0] == 403
    await ana.delete(SEAT)
    assert (await renewed(phone, token))[1]["error"]["code"] == "Conflict"
    await ben.post(SEAT, json={"operator": "human"})
    assert (await renewed(phone, token))[0] == 409
    assert (await offer(phone, token))[0] == 403
    own = (await ben.get(f"{SEAT}/token")).json()["token"]
    expired = sign(replace(verify(token, app_state.secret), expires_s=1.0), app_state.secret)
    for bad in (own, expired, "", "garbage"):
        assert (await renewed(phone, bad))[0] == 403
    assert gateway.offers == []


async def test_a_newer_code_replaces_the_older_one(enter: Enter, room: Room) -> None:
    ana, phone = await seated(enter), await enter()
    older = (await ana.post(f"{SEAT}/pair")).json()["code"]
    newer = (await ana.post(f"{SEAT}/pair")).json()["code"]
    assert (await phone.post("/api/pair", json={"code": older})).status_code == 403
    assert (await phone.post("/api/pair", json={"code": newer})).status_code == 200


async def test_only_the_holder_pairs(enter: Enter, room: Room) -> None:
    await seated(enter)
    answer = await (await enter("Ben")).post(f"{SEAT}/pair")
    assert answer.status_code == 403


async def test_guessing_pairing_codes_keeps_no_phone_out(enter: Enter, room: Room) -> None:
    guesser, ana = await enter(), await seated(enter)
    for i in range(30):
        assert (await guesser.post("/api/pair", json={"code": f"guess-{i}"})).status_code == 403
    code = (await ana.post(f"{SEAT}/pair")).json()["code"]
    assert (await guesser.post("/api/pair", json={"code": code})).status_code == 200


async def test_a_phone_that_cannot_reach_this_computer_is_told(
    enter: Enter, room: Room, app_state: AppState
) -> None:
    app_state.site.lan_host = ""
    pairing = (await (await seated(enter)).post(f"{SEAT}/pair")).json()
    assert "--host 0.0.0.0" in pairing["hint"]


async def test_everybody_is_told_of_the_relays_and_their_credentials(
    enter: Enter, gateway: Gateway, app_state: AppState
) -> None:
    ice = IceSettings(ice_servers='["stun:a.org", "turn:b.org"]', turn_secret="north")
    object.__setattr__(app_state, "ice", ice)
    ana = await seated(enter)
    code = (await ana.post(f"{SEAT}/pair")).json()["code"]
    phone = (await ana.post("/api/pair", json={"code": code})).json()
    bearer = {"Authorization": f"Bearer {phone['token']}"}
    renewed = (await ana.get(f"{SEAT}/phone-token", headers=bearer)).json()
    for told in ((await ana.get(f"{SEAT}/token")).json(), phone, renewed):
        stun, turn = told["ice_servers"]
        assert stun == {"urls": "stun:a.org"}
        assert turn["urls"] == "turn:b.org"
        assert turn["username"].endswith(":mart")
        assert turn["credential"]
