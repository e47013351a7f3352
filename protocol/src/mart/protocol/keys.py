"""Every key expression of the wire, with its quality of service. Nobody else writes a key.

QoS is a property of the message type, so it stands beside the key: commands are small and replaceable (newest wins,
dropped under congestion); states, events and answers must arrive (blocking); video is large and goes last.

States block because a file that lacks one cannot be verified. A subscriber that is slow does not hold up the world: one
that takes nothing for half a second is disconnected, see `bus.zenoh_bus`.
"""

from __future__ import annotations

import enum
import re
from dataclasses import dataclass, replace

from mart.protocol.errors import InvalidInput
from mart.protocol.vocabulary import ServiceKind

ROOT = "mart"
_SEGMENT = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")


class Priority(enum.Enum):
    REAL_TIME = "real_time"
    HIGH = "high"
    NORMAL = "normal"
    LOW = "low"
    BACKGROUND = "background"


@dataclass(frozen=True)
class Topic:
    """A key and how its messages travel. `express`: never wait to fill a batch. `must_arrive`: block, don't drop.

    kept: how many of the newest a publisher keeps for subscribers that missed some and ask for them.
    """

    key: str
    priority: Priority
    express: bool = False
    must_arrive: bool = False
    kept: int = 0


# What a recorder that stood still, or lost its link, asks for again: at 20 ticks a second 100 s of states.
KEPT_STATES = 2048
KEPT_COMMANDS = 2048
KEPT_EVENTS = 512


def command(room: str, arm: str) -> Topic:
    return Topic(_key(room, "arm", arm, "command"), Priority.REAL_TIME, express=True, kept=KEPT_COMMANDS)


def intent(room: str, arm: str) -> Topic:
    """Return where an expert says how an emulated phone is to lead an arm; carries a Command, never reaches the sim."""
    return Topic(_key(room, "arm", arm, "intent"), Priority.NORMAL, express=True)


def in_order(topic: Topic) -> Topic:
    """Return the topic with the delivery of an unpaced room: everything arrives, in the order in which it was said.

    Nothing there waits for a clock, so what is said may be more than what can be recorded: the room has to wait.
    """
    return replace(topic, priority=Priority.HIGH, express=False, must_arrive=True)


def commands(room: str) -> str:
    """All command keys of a room, for subscribers."""
    return f"{ROOT}/{_segment('room', room)}/arm/*/command"


def state(room: str) -> Topic:
    return Topic(_key(room, "state"), Priority.HIGH, express=True, must_arrive=True, kept=KEPT_STATES)


def status(room: str) -> Topic:
    return Topic(_key(room, "status"), Priority.NORMAL)


def event(room: str) -> Topic:
    return Topic(_key(room, "event"), Priority.NORMAL, must_arrive=True, kept=KEPT_EVENTS)


def recording(room: str) -> Topic:
    """Return where a recorder says what it has kept of the episode that goes on."""
    return Topic(_key(room, "recording"), Priority.NORMAL)


def video(room: str, camera: str) -> Topic:
    return Topic(_key(room, "view", camera, "video"), Priority.LOW)


def still(room: str, camera: str) -> Topic:
    return Topic(_key(room, "view", camera, "still"), Priority.LOW)


def camera_frame(room: str, camera: str) -> Topic:
    """Return where a camera's pictures go to the seats that show it; carries CameraFrames."""
    return Topic(_key(room, "view", camera, "frame"), Priority.LOW)


def camera_report(room: str, camera: str) -> Topic:
    """Return where a camera says how it does; carries CameraReports."""
    return Topic(_key(room, "view", camera, "report"), Priority.NORMAL)


DETAILED = b"detailed"


def model(room: str) -> Topic:
    """Queryable: the compiled model; the payload DETAILED asks for the one with detailed meshes, where there is one."""
    return Topic(_key(room, "model"), Priority.LOW, must_arrive=True)


def seat(room: str) -> Topic:
    """Queryable: SeatRequest → RoomReply."""
    return Topic(_key(room, "seat"), Priority.NORMAL, must_arrive=True)


def episode(room: str) -> Topic:
    """Queryable: EpisodeRequest → RoomReply."""
    return Topic(_key(room, "episode"), Priority.NORMAL, must_arrive=True)


def rollout(replica: str) -> Topic:
    """Queryable: RolloutRequest → RolloutReply. A replica is a sim without a room."""
    return Topic(_key(replica, "rollout"), Priority.BACKGROUND, must_arrive=True)


def signal(room: str, arm: str, peer: str) -> Topic:
    """Queryable: Offer → Answer. `peer` is browser, phone or viewer."""
    return Topic(_key(room, "signal", arm, peer), Priority.NORMAL, must_arrive=True)


def voice(room: str, arm: str) -> Topic:
    """Return where a seat's process says what those connected to it say; carries VoicePackets."""
    return Topic(_key(room, "arm", arm, "voice"), Priority.NORMAL, express=True)


def voices(room: str) -> str:
    """All voice keys of a room, for subscribers."""
    return f"{ROOT}/{_segment('room', room)}/arm/*/voice"


def arm_target(room: str, arm: str) -> Topic:
    """Return where a room says what the driver of an arm is to do; carries ArmTargets."""
    return Topic(_key(room, "arm", arm, "target"), Priority.REAL_TIME, express=True)


def arm_measured(room: str, arm: str) -> Topic:
    """Return where the driver of an arm says how it stands; carries ArmMeasured."""
    return Topic(_key(room, "arm", arm, "measured"), Priority.REAL_TIME, express=True)


def driver(room: str) -> Topic:
    """Queryable: DriverHello → DriverReply, of a driver that asks for an arm."""
    return Topic(_key(room, "driver"), Priority.NORMAL, must_arrive=True)


def scene(room: str, arm: str) -> Topic:
    """Queryable: SceneRequest → SceneReply, answered by the process of the arm's seat."""
    return Topic(_key(room, "arm", arm, "scene"), Priority.LOW, must_arrive=True)


def open_seat(gateway: str) -> Topic:
    """Queryable: OpenSeat → OpenSeatReply. `gateway` is the id of a gateway service."""
    return Topic(f"{ROOT}/@gateway/{_segment('gateway', gateway)}/open", Priority.NORMAL, must_arrive=True)


def connection_check(gateway: str) -> Topic:
    """Queryable: Offer → Answer, of a connection that tries the way to this gateway and is good for nothing else."""
    return Topic(f"{ROOT}/@gateway/{_segment('gateway', gateway)}/check", Priority.LOW, must_arrive=True)


def training(trainer: str) -> Topic:
    """Queryable: TrainerRequest → TrainerReply. `trainer` is the id of a trainer service."""
    return Topic(f"{ROOT}/@trainer/{_segment('trainer', trainer)}/jobs", Priority.LOW, must_arrive=True)


def catalogue(catalogue: str) -> Topic:
    """Queryable: CatalogueRequest → CatalogueReply. `catalogue` is the id of a catalogue service."""
    return Topic(
        f"{ROOT}/@catalogue/{_segment('catalogue', catalogue)}/episodes", Priority.LOW, must_arrive=True
    )


def rooms(platform: str) -> Topic:
    """Queryable: RoomsRequest → RoomReply. `platform` is the id of what runs the rooms of a machine."""
    return Topic(
        f"{ROOT}/@platform/{_segment('platform', platform)}/rooms", Priority.NORMAL, must_arrive=True
    )


def alive(kind: ServiceKind, id: str) -> str:
    """Return the liveliness key of one running service."""
    return f"{ROOT}/@live/{_segment('kind', kind)}/{_segment('id', id)}"


def alive_of(kind: ServiceKind) -> str:
    """Return the expression that meets the liveliness keys of every running service of a kind."""
    return f"{ROOT}/@live/{_segment('kind', kind)}/*"


def admission() -> Topic:
    """Queryable: AdmissionRequest → the wire version, answered by the router itself to whom it admits."""
    return Topic(f"{ROOT}/@router/admission", Priority.NORMAL, must_arrive=True)


EVERY_STATE = f"{ROOT}/*/state"
EVERY_STATUS = f"{ROOT}/*/status"
EVERY_EVENT = f"{ROOT}/*/event"
EVERY_COMMAND = f"{ROOT}/*/arm/*/command"
EVERY_INTENT = f"{ROOT}/*/arm/*/intent"
EVERY_RECORDING = f"{ROOT}/*/recording"
EVERY_VIDEO = f"{ROOT}/*/view/*/video"
EVERY_STILL = f"{ROOT}/*/view/*/still"
EVERY_CAMERA_FRAME = f"{ROOT}/*/view/*/frame"
EVERY_CAMERA_REPORT = f"{ROOT}/*/view/*/report"
EVERY_VOICE = f"{ROOT}/*/arm/*/voice"
EVERY_ARM_TARGET = f"{ROOT}/*/arm/*/target"
EVERY_ARM_MEASURED = f"{ROOT}/*/arm/*/measured"
EVERY_MODEL = f"{ROOT}/*/model"
EVERY_SEAT = f"{ROOT}/*/seat"
EVERY_EPISODE = f"{ROOT}/*/episode"
EVERY_DRIVER = f"{ROOT}/*/driver"
EVERY_ROLLOUT = f"{ROOT}/*/rollout"
EVERY_SIGNAL = f"{ROOT}/*/signal/*/*"
EVERY_SCENE = f"{ROOT}/*/arm/*/scene"
EVERY_OPEN_SEAT = f"{ROOT}/@gateway/*/open"
EVERY_CONNECTION_CHECK = f"{ROOT}/@gateway/*/check"
EVERY_TRAINING = f"{ROOT}/@trainer/*/jobs"
EVERY_CATALOGUE = f"{ROOT}/@catalogue/*/episodes"
EVERY_ROOMS = f"{ROOT}/@platform/*/rooms"
EVERY_ALIVE = f"{ROOT}/@live/*/*"


def room_of(key: str) -> str:
    """The room (or replica) that a key belongs to."""
    return key.split("/")[1]


def last_of(key: str) -> str:
    """The last segment: the id in a liveliness key."""
    return key.rsplit("/", 1)[-1]


def camera_of(view_key: str) -> str:
    return view_key.split("/")[3]


def arm_of(command_key: str) -> str:
    return command_key.split("/")[3]


def _key(*segments: str) -> str:
    return "/".join((ROOT, *(_segment("name", segment) for segment in segments)))


def _segment(what: str, value: str) -> str:
    if not _SEGMENT.fullmatch(value):
        raise InvalidInput(
            f"{what} {value!r} was given; use 1 to 64 lower-case letters, digits, '-' or '_', starting with a letter "
            "or digit."
        )
    return value
