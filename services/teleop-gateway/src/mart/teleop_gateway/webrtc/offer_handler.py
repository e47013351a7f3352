"""Answer offers of WebRTC connections to one seat, as the web service hands them over."""

from __future__ import annotations

import logging
from functools import partial

from mart.protocol import clock, keys
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import Answer, Offer
from mart.protocol.queryables import SIGNAL
from mart.protocol.tokens import Role
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Closable
from mart.runtime.rate_limit import RateLimit
from mart.runtime.serving import AsyncRequestAnswerer
from mart.teleop_gateway.input.seat_input import SeatInput
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.webrtc.authorization import authorize_holder, authorize_offer
from mart.teleop_gateway.webrtc.peers import Peers

_log = logging.getLogger(__name__)

MAX_OFFERS_PER_S = 5
_READY_TIMEOUT_S = 5.0


class OfferHandler:
    """Let those in whose token is for this seat and its present holder."""

    def __init__(self, seat: SeatAddress, secret: bytes, seat_input: SeatInput, peers: Peers) -> None:
        """Answer offers. `secret` is what seat tokens are signed with."""
        self._seat, self._secret = seat, secret
        self._input, self._peers = seat_input, peers
        self._limits = {
            role: RateLimit(MAX_OFFERS_PER_S) for role in Role
        }  # viewers spend none of the holder's

    def serve(self, bus: AsyncBus) -> list[Closable]:
        """Answer on the bus, for every role, until what is returned is closed."""
        return [
            bus.serve(keys.signal(self._seat.room, self._seat.arm, role), self._answering(role))
            for role in Role
        ]

    def _answering(self, role: Role) -> AsyncRequestAnswerer[Offer, Answer]:
        def on_refused(error: MartError) -> None:
            _log.info("An offer of a %s was refused: %s", role, error)

        return AsyncRequestAnswerer(SIGNAL, partial(self._answer, role), on_refused)

    async def _answer(self, role: Role, offer: Offer) -> Answer:
        if not self._limits[role].allows(clock.monotonic_s()):
            raise Unavailable(
                f"More than {MAX_OFFERS_PER_S} offers of a {role} a second came for this seat; wait a moment."
            )
        claims = authorize_offer(offer.token, self._secret, self._seat, role)
        driving = await self._input.await_driving(claims.epoch, _READY_TIMEOUT_S)
        authorize_holder(claims, driving.seat_epoch)
        sdp = await self._peers.answer(role, offer.sdp, claims.holder_id, claims.speaks_as, claims.expires_s)
        return Answer(sdp=sdp)
