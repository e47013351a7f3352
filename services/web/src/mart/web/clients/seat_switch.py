"""Let one person leave an arm for the next one that no other person drives."""

from __future__ import annotations

import contextlib

from mart.protocol.errors import Conflict, Forbidden, MartError
from mart.protocol.holders import is_held_by
from mart.protocol.messages import OPERATOR_HUMAN, Seat
from mart.web.access.user_sessions import User
from mart.web.clients.room_client import RoomRequester


async def switch_seat(rooms: RoomRequester, room: str, arm: str, user: User, seats: list[Seat]) -> Seat:
    """Take the next arm's seat in the order of the room, leave `arm`, and return the seat that was taken.

    The arm that is left goes back to the machine from which it was taken, else it holds still. Where it cannot be left,
    the other one is. Raises Forbidden where `arm` is not the user's, Conflict where people drive all others, and what
    the room reports.
    """
    own = next((seat for seat in seats if seat.arm == arm), None)
    if own is None or not is_held_by(own, user.holder_id):
        raise Forbidden(f"{arm} in {room} is not your seat; only its holder can leave it for another one.")
    at = seats.index(own)
    wanted = next((seat for seat in (*seats[at + 1 :], *seats[:at]) if seat.operator != OPERATOR_HUMAN), None)
    if wanted is None:
        raise Conflict(f"People drive every other arm of {room}; wait until one is left.")
    taken = await rooms.take_seat(room, wanted.arm, user)
    try:
        await _leave(rooms, room, own, user)
    except MartError:
        with contextlib.suppress(MartError):  # what went wrong first is told
            await _leave(rooms, room, taken, user)
        raise
    return taken


async def _leave(rooms: RoomRequester, room: str, seat: Seat, user: User) -> None:
    if seat.relieved:
        await rooms.hand_back_seat(room, seat.arm, user)
    else:
        await rooms.leave_seat(room, seat.arm, user)
