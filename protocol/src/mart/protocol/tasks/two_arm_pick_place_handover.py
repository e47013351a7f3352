"""A hammer goes from a lidded container on one shelf to a bin on the other; the paper's task with a handover."""

from __future__ import annotations

import math

import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks.task import Arm, Ghost, Observation, Subtask, Task, proprioception

NAME = "two_arm_pick_place_handover"
DEFAULT_ARMS = 2
ARM_COUNTS = (2,)

# So far apart that the first arm cannot reach the bin, nor the second the container: the hammer must be handed over.
_BASE_DISTANCE_M = 0.78

# Where the hammer is best held out, in the world: both arms get there.
OFFER_M = (0.0, 0.0, 0.25)

_AWAIT = "Wait until your partner holds the hammer out still, then grip the free end of its handle."


_SUBTASKS = (
    Subtask(
        "lid_removed",
        "The container is open",
        coordinated=False,
        arms=("arm0",),
        to_do={"arm0": "Grip the lid by its knob, lift it off and lay it on the empty half of your shelf."},
    ),
    Subtask(
        "trash_cleared",
        "The trash is in the small tray",
        coordinated=False,
        arms=("arm1",),
        to_do={"arm1": "Take the trash cube out of the orange bin and lay it into the small tray."},
    ),
    Subtask(
        "hammer_fetched",
        "The hammer is out of the container",
        coordinated=False,
        arms=("arm0",),
        to_do={
            "arm0": "Grip the hammer's handle close to its head and lift it out of the container.",
            "arm1": _AWAIT,
        },
    ),
    Subtask(
        "hammer_handed_over",
        "The orange arm has the hammer",
        coordinated=True,
        arms=("arm0", "arm1"),
        to_do={
            "arm0": "Hold the hammer still over the middle of the table, where you see a yellow one, "
            "its handle towards your partner.",
            "arm1": _AWAIT,
        },
        ghost=Ghost("hammer", Pose(np.array(OFFER_M), np.array([1.0, 0.0, 0.0, 0.0])), floor_z_m=0.062),
    ),
    Subtask(
        "hammer_placed",
        "The hammer is in the bin",
        coordinated=True,
        arms=("arm1",),
        to_do={"arm1": "Lay the hammer into the orange bin and let go."},
    ),
)


def task(arms: int) -> Task:
    fetcher, receiver = Arm.at(0, -_BASE_DISTANCE_M, 0.0, 0.0), Arm.at(1, _BASE_DISTANCE_M, 0.0, math.pi)
    both = (fetcher.name, receiver.name)
    return Task(
        name=NAME,
        title="Pick-place handover",
        instruction=(
            "Blue takes the lid off the container and fetches the hammer, while orange clears the trash cube from the "
            "bin into the small tray. Then blue hands the hammer over, and orange lays it into the bin."
        ),
        arms=(fetcher, receiver),
        subtasks=_SUBTASKS,
        afterwards="Let go and draw your hand up and back.",
        observations=(
            *proprioception(fetcher.name),
            *_position("container", (fetcher.name,)),
            *_pose("lid", (fetcher.name,)),
            *proprioception(receiver.name),
            *_pose("trash", (receiver.name,)),
            *_position("trash_tray", (receiver.name,)),
            *_position("bin", (receiver.name,)),
            *_pose("hammer", both),
            Observation(f"{fetcher.name}/tool_position_in_world", (3,), "m", (receiver.name,)),
            Observation(f"{receiver.name}/tool_position_in_world", (3,), "m", (fetcher.name,)),
        ),
        horizon_ticks=2000,
        trial_ticks=1440,  # 72 s: practised operators need 19 s
    )


def _pose(thing: str, arms: tuple[str, ...]) -> tuple[Observation, ...]:
    return (
        *_position(thing, arms),
        Observation(f"{thing}/quaternion_in_world", (4,), "wxyz", arms),
    )


def _position(thing: str, arms: tuple[str, ...]) -> tuple[Observation, ...]:
    return (Observation(f"{thing}/position_in_world", (3,), "m", arms),)
