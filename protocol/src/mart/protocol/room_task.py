"""Know the task of a room, with the arms that it has, from what the room says of itself."""

from __future__ import annotations

from mart.protocol.arms import arm_kind
from mart.protocol.errors import MartError
from mart.protocol.messages import Model, RoomStatus
from mart.protocol.tasks import Task, get_task


def task_of_room(status: RoomStatus) -> Task:
    """Return the task. Raises NotFound and InvalidInput for one, or arms, that this version does not know."""
    return get_task(status.task, len(status.seats), status.arm_kinds)


def has_fingers(status: RoomStatus, arm: str) -> bool:
    """Return whether this arm of the room can grip; yes where its kind is not known here."""
    arms = [seat.arm for seat in status.seats]
    if len(status.arm_kinds) != len(arms) or arm not in arms:
        return True
    try:
        return arm_kind(status.arm_kinds[arms.index(arm)]).has_fingers
    except MartError:
        return True


def task_of_model(model: Model) -> Task:
    """Return the task of a compiled model. Raises likewise."""
    return get_task(model.task, len(model.arms), model.arm_kinds)
