"""State what each part may say, hear, answer and ask on the bus: a router between machines gives it that and no more.

A part is known by its certificate. Whatever is not here is denied, so a new key needs a line here.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from mart.protocol import keys
from mart.protocol.vocabulary import ServiceKind


class BusPart(StrEnum):
    """Name what a certificate of the bus is for: a kind of service with its own processes, or a person's commands."""

    PLATFORM = "platform"
    SIM = "sim"
    REPLICA = "replica"
    EXPERTS = "experts"
    GATEWAY = "gateway"  # and the processes of its seats
    RECORDER = "recorder"
    CATALOGUE = "catalogue"
    TRAINER = "trainer"
    POLICIES = "policies"
    DRIVER = "driver"
    CAMERA = "camera"
    PHONE = "phone"
    WEB = "web"
    TOOLS = "tools"  # `mart rooms`, `mart collect`, `mart operate`, operators of one's own


def part_of(kind: ServiceKind) -> BusPart | None:
    """Return as which part a service's process is known; None where it needs no certificate to show."""
    return _PARTS.get(kind)


_PARTS = {ServiceKind(part.value): part for part in BusPart if part != BusPart.TOOLS} | {
    ServiceKind.SEAT: BusPart.GATEWAY,
    ServiceKind.OPERATE: BusPart.TOOLS,
}


@dataclass(frozen=True)
class Rights:
    """Key expressions: what a part puts (`says`), subscribes to, answers (`serves`) and queries (`asks`)."""

    says: tuple[str, ...] = ()
    hears: tuple[str, ...] = ()
    serves: tuple[str, ...] = ()
    asks: tuple[str, ...] = ()
    announces: tuple[ServiceKind, ...] = ()  # the services whose liveliness it may declare


_ROOM = (keys.EVERY_STATE, keys.EVERY_STATUS, keys.EVERY_EVENT)  # what whoever follows a room hears
_DRIVE = Rights(
    (keys.EVERY_COMMAND, keys.EVERY_EVENT), _ROOM, (), (keys.EVERY_SEAT, keys.EVERY_EPISODE, keys.EVERY_MODEL)
)

RIGHTS: dict[BusPart, Rights] = {
    BusPart.PLATFORM: Rights(
        hears=_ROOM,
        serves=(keys.EVERY_ROOMS,),
        asks=(keys.EVERY_SEAT, keys.EVERY_EPISODE),
        announces=(ServiceKind.PLATFORM,),
    ),
    BusPart.SIM: Rights(
        # Commands too: a lockstep room says those that it gave itself, for the recorder.
        says=(*_ROOM, keys.EVERY_COMMAND, keys.EVERY_ARM_TARGET),
        hears=(
            *(keys.EVERY_COMMAND, keys.EVERY_EVENT, keys.EVERY_RECORDING),
            *(keys.EVERY_ARM_MEASURED, keys.EVERY_CAMERA_REPORT),
        ),
        serves=(keys.EVERY_MODEL, keys.EVERY_SEAT, keys.EVERY_EPISODE, keys.EVERY_DRIVER),
        asks=(keys.EVERY_CATALOGUE,),
        announces=(ServiceKind.SIM,),
    ),
    BusPart.REPLICA: Rights(serves=(keys.EVERY_ROLLOUT,), announces=(ServiceKind.REPLICA,)),
    BusPart.EXPERTS: Rights(
        says=(*_DRIVE.says, keys.EVERY_INTENT),
        hears=_DRIVE.hears,
        asks=_DRIVE.asks,
        announces=(ServiceKind.EXPERTS,),
    ),
    BusPart.GATEWAY: Rights(
        says=(
            *(keys.EVERY_COMMAND, keys.EVERY_EVENT, keys.EVERY_VOICE),
            *(keys.EVERY_VIDEO, keys.EVERY_STILL),
        ),
        hears=(*_ROOM, keys.EVERY_VOICE, keys.EVERY_CAMERA_FRAME),
        serves=(
            *(keys.EVERY_OPEN_SEAT, keys.EVERY_CONNECTION_CHECK),
            *(keys.EVERY_SIGNAL, keys.EVERY_SCENE),
        ),
        asks=(keys.EVERY_MODEL, keys.EVERY_SEAT),
        announces=(ServiceKind.GATEWAY, ServiceKind.SEAT),
    ),
    BusPart.RECORDER: Rights(
        says=(keys.EVERY_EVENT, keys.EVERY_RECORDING),
        hears=(*_ROOM, keys.EVERY_COMMAND, keys.EVERY_VIDEO),
        asks=(keys.EVERY_MODEL, keys.EVERY_ROLLOUT),
        announces=(ServiceKind.RECORDER,),
    ),
    BusPart.CATALOGUE: Rights(
        serves=(keys.EVERY_CATALOGUE,), asks=(keys.EVERY_ROLLOUT,), announces=(ServiceKind.CATALOGUE,)
    ),
    BusPart.TRAINER: Rights(
        serves=(keys.EVERY_TRAINING,), asks=(keys.EVERY_ROLLOUT,), announces=(ServiceKind.TRAINER,)
    ),
    BusPart.POLICIES: Rights(_DRIVE.says, _DRIVE.hears, (), _DRIVE.asks, (ServiceKind.POLICIES,)),
    BusPart.DRIVER: Rights(
        says=(keys.EVERY_ARM_MEASURED,),
        hears=(keys.EVERY_ARM_TARGET, keys.EVERY_STATUS),
        asks=(keys.EVERY_DRIVER, keys.EVERY_MODEL),
        announces=(ServiceKind.DRIVER,),
    ),
    BusPart.CAMERA: Rights(
        says=(keys.EVERY_CAMERA_FRAME, keys.EVERY_CAMERA_REPORT, keys.EVERY_VIDEO),
        hears=(keys.EVERY_STATE, keys.EVERY_STATUS),
        announces=(ServiceKind.CAMERA,),
    ),
    BusPart.PHONE: Rights(
        hears=(keys.EVERY_INTENT, *_ROOM), asks=(keys.EVERY_MODEL,), announces=(ServiceKind.PHONE,)
    ),
    BusPart.WEB: Rights(
        hears=(keys.EVERY_STATUS, keys.EVERY_EVENT, keys.EVERY_STILL),
        asks=(
            *(keys.EVERY_SEAT, keys.EVERY_EPISODE, keys.EVERY_SIGNAL, keys.EVERY_SCENE),
            *(keys.EVERY_OPEN_SEAT, keys.EVERY_CONNECTION_CHECK),
            *(keys.EVERY_ROOMS, keys.EVERY_TRAINING, keys.EVERY_CATALOGUE),
        ),
        announces=(ServiceKind.WEB,),
    ),
    BusPart.TOOLS: Rights(
        says=_DRIVE.says,
        hears=_DRIVE.hears,
        asks=(
            *_DRIVE.asks,
            *(keys.EVERY_ROLLOUT, keys.EVERY_ROOMS, keys.EVERY_TRAINING, keys.EVERY_CATALOGUE),
        ),
        announces=(ServiceKind.OPERATE,),
    ),
}
