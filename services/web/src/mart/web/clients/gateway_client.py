"""From a peer's offer to the gateway's answer: pick the seat's gateway, have it open the seat, hand the offer over."""

from __future__ import annotations

from collections.abc import Iterable

from mart.protocol import codec, keys
from mart.protocol.gateway_choice import gateway_of
from mart.protocol.messages import Answer, Offer, OpenSeat, OpenSeatReply, raise_error
from mart.protocol.tokens import SeatToken
from mart.runtime.bus.aio import AsyncBus

_OPEN_TIMEOUT_S = 20.0  # a gateway may have to fetch and load the room's model first
_OFFER_TIMEOUT_S = 10.0
_MAX_ANSWER_BYTES = 64 * 1024


async def answer_offer(bus: AsyncBus, gateways: Iterable[str], seat: SeatToken, token: str, sdp: str) -> str:
    """The answer's SDP. Raises Unavailable where no gateway runs, and whatever the gateway reports."""
    gateway = gateway_of(gateways, seat.room, seat.arm)
    opening = OpenSeat(room=seat.room, arm=seat.arm, seat_epoch=seat.epoch)
    opened = await bus.query(keys.open_seat(gateway), codec.encode(opening), _OPEN_TIMEOUT_S)
    raise_error(codec.decode(OpenSeatReply, opened, _MAX_ANSWER_BYTES).error)
    topic = keys.signal(seat.room, seat.arm, seat.role.value)
    reply = await bus.query(topic, codec.encode(Offer(token=token, sdp=sdp)), _OFFER_TIMEOUT_S)
    answer = codec.decode(Answer, reply, _MAX_ANSWER_BYTES)
    raise_error(answer.error)
    return answer.sdp
