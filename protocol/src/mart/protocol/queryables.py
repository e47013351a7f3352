"""Name every question that a service answers on the bus: what is asked, what is answered, how long a question may be.

`mart.protocol.keys` has their keys. The compiled model of a room is asked for by a word, not by a message, so it is
not among them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from google.protobuf.message import Message

from mart.protocol import codec
from mart.protocol.messages import (
    Answer,
    CatalogueReply,
    CatalogueRequest,
    EpisodeRequest,
    Offer,
    OpenSeat,
    OpenSeatReply,
    RolloutReply,
    RolloutRequest,
    RoomReply,
    RoomsRequest,
    SeatRequest,
    TrainerReply,
    TrainerRequest,
)

Q = TypeVar("Q", bound=Message, covariant=True)  # noqa: PLC0105 - a question's and an answer's type
R = TypeVar("R", bound=Message, covariant=True)  # noqa: PLC0105

MAX_SDP_CHARACTERS = 65536


@dataclass(frozen=True)
class Queryable(Generic[Q, R]):
    """Describe one kind of question. Every reply has a field `error`."""

    name: str
    request_type: type[Q]
    reply_type: type[R]
    limit_bytes: int  # of a request


SEAT = Queryable("seat", SeatRequest, RoomReply, 4096)
EPISODE = Queryable("episode", EpisodeRequest, RoomReply, 4096)
ROOMS = Queryable("rooms", RoomsRequest, RoomReply, 1024)
OPEN_SEAT = Queryable("open", OpenSeat, OpenSeatReply, 1024)
SIGNAL = Queryable("signal", Offer, Answer, MAX_SDP_CHARACTERS + 4096)
ROLLOUT = Queryable("rollout", RolloutRequest, RolloutReply, codec.MAX_MESSAGE_BYTES)
CATALOGUE = Queryable("catalogue", CatalogueRequest, CatalogueReply, 64 * 1024)
TRAINING = Queryable("jobs", TrainerRequest, TrainerReply, 64 * 1024)

QUERYABLES: tuple[Queryable[Message, Message], ...] = (
    SEAT, EPISODE, ROOMS, OPEN_SEAT, SIGNAL, ROLLOUT, CATALOGUE, TRAINING,
)  # fmt: skip
