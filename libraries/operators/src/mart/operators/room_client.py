"""Ask a room for seats and episodes, and wait for its answer."""

from __future__ import annotations

from mart.protocol import keys
from mart.protocol.messages import (
    OPERATOR_POLICY,
    EpisodeRequest,
    Operator,
    RoomReply,
    Seat,
    SeatRequest,
)
from mart.runtime.ask import ask
from mart.runtime.bus import Bus

_TIMEOUT_S = 5.0


class RoomClient:
    """Speak to one room over the bus.

    Every call raises what the room answers (Conflict, Forbidden, InvalidInput, NotFound), and Unavailable where it does
    not answer. A request whose answer is lost is asked again and done once.
    """

    def __init__(self, bus: Bus, room: str) -> None:
        self.room = room
        self._bus = bus

    def claim(self, arm: str, holder_id: str, name: str, operator: Operator = OPERATOR_POLICY) -> Seat:
        """Take a seat for a holder, and return it as it is then; raises Conflict where somebody else sits there."""
        claim = SeatRequest.Claim(arm=arm, holder_id=holder_id, name=name, operator=operator)
        return self._ask_seat(SeatRequest(claim=claim)).seat

    def release(self, arm: str, holder_id: str) -> None:
        """Leave a seat that this holder has."""
        self._ask_seat(SeatRequest(release=SeatRequest.Release(arm=arm, holder_id=holder_id)))

    def assign(self, arm: str, operator: Operator, policy: str = "") -> None:
        """Give a seat in which no person sits to a script, a promoted policy, or nobody (hold)."""
        assign = SeatRequest.Assign(arm=arm, operator=operator, policy=policy)
        self._ask_seat(SeatRequest(assign=assign))

    def ready(self, arm: str, holder_id: str = "", number: int = 0) -> None:
        """Say that this arm is ready for an episode, the next one or that of a number."""
        ready = EpisodeRequest.Ready(arm=arm, holder_id=holder_id, ready=True, number=number)
        ask(self._bus, keys.episode(self.room), EpisodeRequest(ready=ready), RoomReply, _TIMEOUT_S)

    def _ask_seat(self, request: SeatRequest) -> RoomReply:
        return ask(self._bus, keys.seat(self.room), request, RoomReply, _TIMEOUT_S)
