"""Say which seats policies drive: all that name a promoted one, or those that were claimed for one of one's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import TYPE_CHECKING

from mart.operators.commander import SeatCommander
from mart.operators.driver import SeatSelection
from mart.operators.obedience import ObedientOperator
from mart.operators.operator import Operator
from mart.protocol.control_rate import ticks_for_each
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import OPERATOR_POLICY, RoomStatus
from mart.protocol.room_task import task_of_room
from mart.protocol.tasks import Task
from mart.protocol.vocabulary import ServiceKind
from mart.trainer.models.policies.policy import pictures_of
from mart.trainer.serve.policy_operator import PolicyOperator, parts_of

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy

LoadPolicy = Callable[[Path], "Policy"]


class PromotedPolicies(SeatSelection[str]):
    """Select every seat that names a promoted policy, a folder below `policies_dir`."""

    kind = ServiceKind.POLICIES

    def __init__(self, policies_dir: Path, load: LoadPolicy, loader: Executor) -> None:
        """Load with `load` on the thread of `loader`: meanwhile the policies of other seats drive on."""
        self._policies_dir, self._load, self._loader = policies_dir, load, loader
        self._loading: dict[tuple[str, str], Future[Policy]] = {}  # by room and name

    def assigned(self, room: str, status: RoomStatus) -> Mapping[str, Mapping[str, int]]:
        """Return the seats to drive, by the name of their policy; see `SeatSelection`."""
        seats: dict[str, dict[str, int]] = {}
        for seat in status.seats:
            if seat.operator == OPERATOR_POLICY and seat.policy:
                seats.setdefault(seat.policy, {})[seat.arm] = seat.epoch
        for place in [place for place in self._loading if place[0] == room and place[1] not in seats]:
            self._loading.pop(place).cancel()
        return seats

    def commanders(self, key: str, status: RoomStatus) -> Sequence[SeatCommander] | None:
        """Return the policy's, None while it is loaded; see `SeatSelection`.

        Raises where it cannot be loaded or does not fit the room.
        """
        place = status.room, key
        loading = self._loading.get(place)
        if loading is None:
            loading = self._loader.submit(self._load, self._policies_dir / key)
            self._loading[place] = loading
        if not loading.done():
            return None
        del self._loading[place]
        return policy_commanders(loading.result(), status)

    def name_of(self, key: str) -> str:
        """Return what people call it; see `SeatSelection`."""
        return f"The policy {key}"


def policy_commanders(policy: Policy, status: RoomStatus) -> Sequence[SeatCommander]:
    """Return what a policy drives with in a room of this status: one commander for each of its independent parts.

    Raises InvalidInput as `commander_of`, and for a policy that sees.
    """
    if pictures_of(policy):
        raise InvalidInput(
            "It is shown pictures; seat it with `mart operate --checkpoint`, which draws them."
        )
    return [commander_of(part, PolicyOperator(part), status) for part in parts_of(policy)]


def commander_of(policy: Policy, operator: Operator, status: RoomStatus) -> SeatCommander:
    """Return what one part of a policy drives with, by its operator, in a room of this status.

    It obeys its partners' cues, and acts at its own rate also where the room's is a multiple of it. Raises InvalidInput
    where the policy was not made for such a room, or the room's rate is no multiple.
    """
    task = task_of_room(status)
    require_fit(policy, task)
    each = ticks_for_each(policy.control_hz, status.control_hz)
    return SeatCommander(
        ObedientOperator(operator), task, policy.arms, OPERATOR_POLICY, policy.needs, act_every_ticks=each
    )


def require_fit(policy: Policy, task: Task) -> None:
    """Raise InvalidInput where the policy was not made for such a room, whatever its rate."""
    if policy.task != task.name:
        raise InvalidInput(f"It was trained for {policy.task} and the room's task is {task.name}.")
    if policy.arm_kinds != task.arm_kinds:
        raise InvalidInput(
            f"It was trained with {', '.join(policy.arm_kinds) or 'Pandas'} (arm_kinds) and the room has "
            f"{', '.join(task.arm_kinds) or 'Pandas'}: open a room with those arms, or train on episodes of these."
        )
    unknown = sorted(set(policy.needs) - {observation.name for observation in task.observations})
    if unknown:
        raise InvalidInput(
            f"It needs {', '.join(unknown)}, which nobody sees in a room of {len(task.arms)} arms."
        )
