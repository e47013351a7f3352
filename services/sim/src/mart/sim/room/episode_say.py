"""Decide who has a say in an episode, and what they are called. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from mart.protocol.errors import Forbidden
from mart.protocol.messages import (
    ENDED_BY_OPERATOR,
    ENDED_BY_UNSPECIFIED,
    OPERATOR_HUMAN,
    EndedBy,
    EpisodeRequest,
)
from mart.sim.room.seats import SeatHolder, SeatTable, require_name


@dataclass(frozen=True)
class EpisodeEnder:
    """Tell what brought an episode to its end; of an operator, the name that others see and the arm."""

    by: EndedBy = ENDED_BY_UNSPECIFIED
    name: str = ""
    arm: str = ""


def require_say(seats: SeatTable, about: tuple[SeatHolder, ...], holder_id: str) -> None:
    """Raise Forbidden unless the holder sits in one of the seats `about`; where no human sits, anybody may say."""
    if any(holder_id and seat.holder_id == holder_id for seat in about):
        return
    if holder_id or seats.of_operator(OPERATOR_HUMAN):
        raise Forbidden("This is decided by those who drive; take a seat to have a say.")


def ender_of(seats: SeatTable, said: EpisodeRequest.Finish | EpisodeRequest.Reset) -> EpisodeEnder:
    """Return who says it: a host, the holder of a seat, or somebody without a name where no human sits.

    Raises Forbidden where they have no say, InvalidInput where a host's name cannot be shown.
    """
    if said.host:
        require_name(said.host)
        return EpisodeEnder(ENDED_BY_OPERATOR, said.host)
    require_say(seats, tuple(seats), said.holder_id)
    held = next(iter(seats.of_holder(said.holder_id)), None)
    return EpisodeEnder(ENDED_BY_OPERATOR, held.name, held.arm) if held else EpisodeEnder(ENDED_BY_OPERATOR)


def called(ender: EpisodeEnder) -> str:
    """Return who ended something, in words; whoever has a name and no arm is a host."""
    if not ender.name:
        return "an operator"
    return ender.name if ender.arm else f"{ender.name}, the host"
