"""What a peer's offer needs: its seat's gateway is chosen, opens the seat and answers the offer."""

from __future__ import annotations

from collections.abc import Iterable

from mart.protocol import keys
from mart.protocol.gateway_choice import gateway_of
from mart.protocol.messages import Answer, Offer, OpenSeat, OpenSeatReply, SceneReply, SceneRequest
from mart.protocol.tokens import SeatToken
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.ask import ask_async
from mart.runtime.bus.aio import AsyncBus
from mart.web.clients.running_services import running_ids
from mart.web.lobby.lobby import Lobby

_OPEN_TIMEOUT_S = 20.0  # a gateway may have to fetch and load the room's model first
_OFFER_TIMEOUT_S = 10.0
_CHECKED = "check"  # in place of a room and an arm: whoever checks has none yet
_SCENE_TIMEOUT_S = (
    15.0  # it is made where nobody has asked for it yet: 0.1 s, detailed 0.6, and more where all is busy
)
_MAX_SCENE_REPLY_BYTES = 16 * 1024 * 1024


class GatewayClient:
    """Requests to the gateways."""

    def __init__(self, bus: AsyncBus, lobby: Lobby) -> None:
        self._bus, self._lobby = bus, lobby

    async def answer_offer(self, seat: SeatToken, token: str, sdp: str) -> str:
        """Return the SDP of the answer to the offer `sdp`, which `token`, saying `seat`, came with.

        Raises Unavailable where no gateway runs, and whatever the gateway reports.
        """
        await self._open(seat.room, seat.arm, seat.epoch)
        topic = keys.signal(seat.room, seat.arm, seat.role.value)
        offer = Offer(token=token, sdp=sdp)
        return (await ask_async(self._bus, topic, offer, Answer, timeout_s=_OFFER_TIMEOUT_S)).sdp

    async def answer_check(self, sdp: str) -> str:
        """Return the SDP of the answer to an offer that only tries the way to a gateway.

        Raises Unavailable where no gateway runs, and whatever the gateway reports.
        """
        gateway = await self._gateway(_CHECKED, _CHECKED)
        topic = keys.connection_check(gateway)
        return (await ask_async(self._bus, topic, Offer(sdp=sdp), Answer, timeout_s=_OFFER_TIMEOUT_S)).sdp

    async def scene(self, room: str, arm: str, known_sha256: Iterable[str]) -> SceneReply:
        """Return the scene of a seat's room, without its bytes where it is known; raises as `answer_offer` does."""
        await self._open(room, arm, 0)
        request = SceneRequest(known_sha256=known_sha256)
        return await ask_async(
            self._bus,
            keys.scene(room, arm),
            request,
            SceneReply,
            timeout_s=_SCENE_TIMEOUT_S,
            limit_bytes=_MAX_SCENE_REPLY_BYTES,
        )

    async def _open(self, room: str, arm: str, seat_epoch: int) -> None:
        """Return when the seat's process is there, for the holder of this epoch or a later one."""
        gateway = await self._gateway(room, arm)
        opening = OpenSeat(room=room, arm=arm, seat_epoch=seat_epoch)
        await ask_async(self._bus, keys.open_seat(gateway), opening, OpenSeatReply, timeout_s=_OPEN_TIMEOUT_S)

    async def _gateway(self, room: str, arm: str) -> str:
        return gateway_of(await running_ids(self._lobby, ServiceKind.GATEWAY), room, arm)
