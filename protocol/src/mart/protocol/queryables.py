"""Name everything that travels on the bus: what is said on which key, and what is asked and answered.

The compiled model of a room is asked for by a word, not by a message; it is a question all the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from google.protobuf.message import Message

from mart.protocol import codec, keys
from mart.protocol.keys import Topic
from mart.protocol.messages import (
    Answer,
    ArmMeasured,
    ArmTarget,
    CameraFrame,
    CameraReport,
    CatalogueReply,
    CatalogueRequest,
    Command,
    DriverHello,
    DriverReply,
    EpisodeRequest,
    Event,
    Offer,
    OpenSeat,
    OpenSeatReply,
    RecordingReport,
    RolloutReply,
    RolloutRequest,
    RoomReply,
    RoomsRequest,
    RoomStatus,
    SceneReply,
    SceneRequest,
    SeatRequest,
    State,
    TrainerReply,
    TrainerRequest,
    VoicePacket,
)

Q = TypeVar("Q", bound=Message, covariant=True)  # noqa: PLC0105 - a question's and an answer's type
R = TypeVar("R", bound=Message, covariant=True)  # noqa: PLC0105

MAX_SDP_CHARACTERS = 65536


@dataclass(frozen=True)
class Broadcast:
    """Describe what is said to whoever listens; `message_type` is None for what other projects define."""

    topic: Callable[..., Topic]
    message_type: type[Message] | None


@dataclass(frozen=True)
class Queryable(Generic[Q, R]):
    """Describe one kind of question. Every reply has a field `error`."""

    name: str
    topic: Callable[..., Topic]
    request_type: type[Q]
    reply_type: type[R]
    limit_bytes: int  # of a request


SEAT = Queryable("seat", keys.seat, SeatRequest, RoomReply, 4096)
EPISODE = Queryable("episode", keys.episode, EpisodeRequest, RoomReply, 4096)
ROOMS = Queryable("rooms", keys.rooms, RoomsRequest, RoomReply, 1024)
OPEN_SEAT = Queryable("open", keys.open_seat, OpenSeat, OpenSeatReply, 1024)
SIGNAL = Queryable("signal", keys.signal, Offer, Answer, MAX_SDP_CHARACTERS + 4096)
CONNECTION_CHECK = Queryable("check", keys.connection_check, Offer, Answer, MAX_SDP_CHARACTERS + 4096)
SCENE = Queryable("scene", keys.scene, SceneRequest, SceneReply, 4096)
ROLLOUT = Queryable("rollout", keys.rollout, RolloutRequest, RolloutReply, codec.MAX_MESSAGE_BYTES)
CATALOGUE = Queryable("catalogue", keys.catalogue, CatalogueRequest, CatalogueReply, 64 * 1024)
DRIVER = Queryable("driver", keys.driver, DriverHello, DriverReply, 4096)
TRAINING = Queryable("jobs", keys.training, TrainerRequest, TrainerReply, 64 * 1024)

BROADCASTS = (
    Broadcast(keys.command, Command),
    Broadcast(keys.intent, Command),
    Broadcast(keys.state, State),
    Broadcast(keys.status, RoomStatus),
    Broadcast(keys.event, Event),
    Broadcast(keys.recording, RecordingReport),
    Broadcast(keys.voice, VoicePacket),
    Broadcast(keys.arm_target, ArmTarget),
    Broadcast(keys.arm_measured, ArmMeasured),
    Broadcast(keys.camera_frame, CameraFrame),
    Broadcast(keys.camera_report, CameraReport),
    Broadcast(keys.video, None),
    Broadcast(keys.still, None),
)

QUERYABLES: tuple[Queryable[Message, Message], ...] = (
    SEAT, EPISODE, ROOMS, OPEN_SEAT, SIGNAL, CONNECTION_CHECK, SCENE, ROLLOUT, CATALOGUE, TRAINING, DRIVER,
)  # fmt: skip
