"""States and statuses of a room that nobody simulates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from mart.operators import Operator, SeatView, ToolTarget
from mart.protocol.holders import holder_tag
from mart.protocol.messages import (
    OPERATOR_POLICY,
    ArmState,
    Observation,
    RoomStatus,
    Seat,
    State,
    pose_message,
)
from mart.protocol.pose import Pose
from mart.protocol.tasks import Task, get_task

TASK: Task = get_task("two_arm_multi_cube_lifting")
POSE = Pose(np.array([0.5, 0.0, 0.3]), np.array([1.0, 0.0, 0.0, 0.0]))


def state_of(
    tick: int, *, boot: int = 1, episode: int = 1, sequence: int = 0, after_reset: bool = False
) -> State:
    """A state of the cubes' room; its observations are all zeros."""
    return State(
        boot=boot,
        tick=tick,
        episode=episode,
        sim_time_s=tick / 20,
        arms=[
            ArmState(
                arm=arm,
                sequence=sequence,
                tool_in_base=pose_message(POSE),
                action=() if after_reset else [0.0] * 7,
            )
            for arm in TASK.arm_names
        ],
        observations=[
            Observation(name=one.name, value=[0.0] * int(np.prod(one.shape))) for one in TASK.observations
        ],
    )


def status_of(seats: Sequence[Seat]) -> RoomStatus:
    """A status of the cubes' room with these seats."""
    return RoomStatus(room="room-1", task=TASK.name, control_hz=20.0, seats=seats)


def seat_of(arm: str, epoch: int = 2, holder_id: str = "") -> Seat:
    """A seat that a policy holds."""
    tag = holder_tag("1", arm, epoch, holder_id)
    return Seat(arm=arm, epoch=epoch, operator=OPERATOR_POLICY, holder_tag=tag, name="mine")


class Riser(Operator):
    """Lifts every arm of its own by a centimetre a tick, and keeps what it was told and shown."""

    def __init__(self) -> None:
        self.begun: list[int] = []
        self.views: list[SeatView] = []

    def begin(self, episode: int) -> None:
        self.begun.append(episode)

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        self.views.append(view)
        return {arm: view.step(arm, (0.0, 0.0, 0.01)) for arm in view.poses_tool_in_base}
