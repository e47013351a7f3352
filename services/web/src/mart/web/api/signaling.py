"""Tokens, pairing and offers: how a browser or a phone gets to its seat's gateway."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Header, Request
from pydantic import BaseModel, Field

from mart.protocol import clock
from mart.protocol.errors import Conflict, Forbidden
from mart.protocol.holders import is_held_by
from mart.protocol.messages import OPERATOR_HOLD, OPERATOR_HUMAN, OPERATOR_POLICY, Seat
from mart.protocol.queryables import MAX_SDP_CHARACTERS
from mart.protocol.tokens import Role, SeatToken, sign, verify
from mart.web.access.pairing_codes import LIFETIME_S, PairingGrant
from mart.web.access.site_names import host_name, is_loopback
from mart.web.access.user_sessions import User
from mart.web.api.app_state import AppState
from mart.web.api.dependencies import Address, App, JoinedUser, MaybeUser, WatchingUser, now_unix_s
from mart.web.api.invitation import UNREACHABLE
from mart.web.api.qr_codes import qr_svg
from mart.web.api.texts import Word
from mart.web.errors import NotJoined
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api")

Authorization = Annotated[str, Header()]
MaybeAuthorization = Annotated[str | None, Header()]

_BROWSER_TOKEN_S = 300.0  # a page asks for a new one whenever it connects
_SPEAKING_VIEWER_TOKEN_S = 20.0  # of a host, whose page asks for a new one while they talk
_SEEN_OPERATORS = (OPERATOR_HUMAN, OPERATOR_POLICY)  # whose seats gateways draw
_PHONE_TOKEN_S = 12 * 3600.0  # however often it is renewed


class PairingRequest(BaseModel):
    """The code that a phone has scanned."""

    code: Word


class SdpOffer(BaseModel):
    """A WebRTC offer."""

    sdp: str = Field(max_length=MAX_SDP_CHARACTERS)


@router.get("/rooms/{room}/seats/{arm}/token")
async def token(room: str, arm: str, app: App, user: WatchingUser) -> Json:
    """Send a token for a seat: its holder's drives, anybody else's watches."""
    claims = _page_claims(app, room, arm, user)
    return {"token": _sign(app, claims), **_told_with(app, claims)}


@router.post("/rooms/{room}/seats/{arm}/pair")
async def pair(room: str, arm: str, request: Request, app: App, user: JoinedUser) -> Json:
    """Send a code, also as a picture, that pairs a phone with the user's seat."""
    seat = _own_seat(app, room, arm, user)
    pairing = PairingGrant(room, arm, seat.epoch, user.holder_id, user.name)
    code = app.pairing_codes.issue(pairing, clock.monotonic_s())
    host = app.site.for_others(request.headers["host"])
    url = f"https://{host}/phone#{code}"
    return {
        "code": code,
        "url": url,
        "expires_s": LIFETIME_S,
        "qr_svg": qr_svg(url),
        "hint": UNREACHABLE if is_loopback(host_name(host)) else "",
    }


@router.post("/pair")
async def redeem(body: PairingRequest, app: App) -> Json:
    """Send the phone that gives a code its token. Nobody guesses 128 bits in two minutes, however often they try."""
    pairing = app.pairing_codes.redeem(body.code, clock.monotonic_s())
    seat = SeatToken(
        pairing.room,
        pairing.arm,
        pairing.epoch,
        Role.PHONE,
        pairing.holder_id,
        now_unix_s() + _PHONE_TOKEN_S,
        speaks_as=pairing.name,
    )
    return {
        "token": _sign(app, seat),
        "room": pairing.room,
        "arm": pairing.arm,
        "epoch": pairing.epoch,
        "name": pairing.name,
        "role": Role.PHONE.value,
        "speaks_as": pairing.name,
        "ice_servers": ice_servers_json(app),
    }


@router.get("/rooms/{room}/seats/{arm}/phone-token")
async def phone_token(room: str, arm: str, app: App, authorization: Authorization = "") -> Json:
    """Send a phone its renewed token.

    It stays with the user who paired it: its token is renewed while, and whenever, they hold the seat, and is for the
    arm that they went on to from there, where they did.
    """
    paired = claims_of(app, room, arm, authorization)
    if paired.role is not Role.PHONE:
        raise Forbidden(f"The token of a {paired.role} was given; only a phone's is renewed here.")
    seat = _seat(app, room, arm)
    if not is_held_by(seat, paired.holder_id):
        seat = _seat(app, room, app.seat_switches.arm_of(room, paired.holder_id, arm))
    if not is_held_by(seat, paired.holder_id):
        driver = "Nobody" if seat.operator == OPERATOR_HOLD else seat.name or "A script"
        raise Conflict(
            f"{driver} drives {seat.arm} now; this phone goes on when the person who paired it takes the seat again."
        )
    renewed = replace(paired, arm=seat.arm, epoch=seat.epoch)
    return {
        "token": _sign(app, renewed),
        "arm": seat.arm,
        "epoch": seat.epoch,
        "speaks_as": renewed.speaks_as,
        "ice_servers": ice_servers_json(app),
    }


@router.post("/rooms/{room}/seats/{arm}/offer")
async def offer(
    room: str,
    arm: str,
    body: SdpOffer,
    *,
    app: App,
    user: MaybeUser,
    address: Address,
    authorization: MaybeAuthorization = None,
) -> Json:
    """Have the seat's gateway answer an offer and send the answer.

    A page of somebody who has joined needs no token: one round trip less, and it is told what a token would tell.
    """
    if authorization is None:
        if user is None:
            raise NotJoined
        claims = _page_claims(app, room, arm, user)
        token, told = _sign(app, claims), _told_with(app, claims)
        if _seat(app, room, arm).operator not in _SEEN_OPERATORS:
            raise Conflict(
                f"Nobody drives {arm} in {room} whose picture could be shown; take the seat first."
            )
    else:
        claims, token, told = claims_of(app, room, arm, authorization), bearer_of(authorization), {}
        if claims.epoch != _seat(app, room, arm).epoch:
            raise Forbidden(
                "This seat has changed hands since you got your token; take a seat in the lobby again."
            )
    app.offers.spend(f"{claims.holder_id} {claims.role}", clock.monotonic_s())
    app.offers_from_address.spend(address, clock.monotonic_s())
    return {"sdp": await app.gateways.answer_offer(claims, token, body.sdp), **told}


def _page_claims(app: AppState, room: str, arm: str, user: User) -> SeatToken:
    """Return what a page of this user may do at a seat: its holder's drives, anybody else's watches.

    Whoever holds it or hosts may speak, everybody else hears.
    """
    seat = _seat(app, room, arm)
    role = Role.BROWSER if is_held_by(seat, user.holder_id) else Role.VIEWER
    speaks = role is Role.BROWSER or user.hosts
    renews = speaks and role is Role.VIEWER
    expires_s = now_unix_s() + (_SPEAKING_VIEWER_TOKEN_S if renews else _BROWSER_TOKEN_S)
    return SeatToken(
        room, arm, seat.epoch, role, user.holder_id, expires_s, speaks_as=user.name if speaks else ""
    )


def _told_with(app: AppState, claims: SeatToken) -> Json:
    return {
        "role": claims.role.value,
        "epoch": claims.epoch,
        "speaks_as": claims.speaks_as,
        "ice_servers": ice_servers_json(app),
    }


def ice_servers_json(app: AppState) -> list[dict[str, str]]:
    """Return them as a browser's RTCPeerConnection takes them, with credentials that are good for a session."""
    return [server.as_json() for server in app.ice.ice_servers_at(now_unix_s())]


def bearer_of(authorization: str) -> str:
    """Return the token of an Authorization header; empty where there is none."""
    return authorization.removeprefix("Bearer ")


def claims_of(app: AppState, room: str, arm: str, authorization: str) -> SeatToken:
    """Return what the sent token says; raises Forbidden where it is not good for this seat."""
    claims = verify(bearer_of(authorization), app.secret)
    if (claims.room, claims.arm) != (room, arm):
        raise Forbidden(f"This seat token is for {claims.arm} in {claims.room}, not for {arm} in {room}.")
    return claims


def _seat(app: AppState, room: str, arm: str) -> Seat:
    return app.lobby.rooms.seat(room, arm, clock.monotonic_s())


def _own_seat(app: AppState, room: str, arm: str, user: User) -> Seat:
    seat = _seat(app, room, arm)
    if not is_held_by(seat, user.holder_id):
        raise Forbidden(f"{arm} in {room} is not your seat; only its holder can pair a phone with it.")
    return seat


def _sign(app: AppState, token: SeatToken) -> str:
    return sign(token, app.secret)
