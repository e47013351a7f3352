"""What the page that checks a device asks: the server's time, and a connection that only tries the way to a gateway.

The time is for everybody. Connections and relays are for whoever may come in: by a session, a phone's token, or the
join code.
"""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import APIRouter, Header
from pydantic import BaseModel, Field

from mart.protocol import clock
from mart.protocol.queryables import MAX_SDP_CHARACTERS
from mart.protocol.tokens import verify
from mart.web.access.certificate import days_left
from mart.web.access.user_sessions import User
from mart.web.api.app_state import AppState
from mart.web.api.dependencies import Address, App, MaybeUser, now_unix_s, require_join_code
from mart.web.api.signaling import bearer_of, ice_servers_json
from mart.web.api.texts import Word
from mart.web.errors import NotJoined
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api/check")

Authorization = Annotated[str, Header()]


class CheckRequest(BaseModel):
    """The join code, from somebody who has not joined."""

    code: Word = ""


class CheckOffer(CheckRequest):
    """A WebRTC offer of a connection with a data channel alone."""

    sdp: str = Field(max_length=MAX_SDP_CHARACTERS)


@router.get("")
async def time(app: App) -> Json:
    """Send the time, and how long the certificate is good."""
    return {"unix_s": now_unix_s(), "certificate_days": days_left(app.certificate, now_unix_s())}


@router.post("/servers")
async def servers(
    body: CheckRequest, *, app: App, user: MaybeUser, address: Address, authorization: Authorization = ""
) -> Json:
    """Send the STUN and TURN servers that pages use."""
    await _require_admitted(app, user, authorization, body.code, address)
    return {"ice_servers": ice_servers_json(app)}


@router.post("/offer")
async def offer(
    body: CheckOffer, *, app: App, user: MaybeUser, address: Address, authorization: Authorization = ""
) -> Json:
    """Have a gateway answer an offer, and send the answer; the connection ends after some seconds."""
    await _require_admitted(app, user, authorization, body.code, address)
    app.offers_from_address.spend(address, clock.monotonic_s())
    return {"sdp": await app.gateways.answer_check(body.sdp)}


async def _require_admitted(
    app: AppState, user: User | None, authorization: str, code: str, address: str
) -> None:
    """Raise NotJoined where nothing was given that lets somebody in, Forbidden where it is not right."""
    if user is not None:
        return
    if bearer_of(authorization):
        verify(bearer_of(authorization), app.secret)
    elif code:
        await asyncio.sleep(app.wrong_codes.delay_s(address, clock.monotonic_s()))
        require_join_code(app, code, address)
    else:
        raise NotJoined
