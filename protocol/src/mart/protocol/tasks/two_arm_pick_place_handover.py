"""A hammer goes from a lidded container on one shelf to a bin on the other; the paper's task with a handover."""

from __future__ import annotations

import math

from mart.protocol.tasks.task import Arm, Observation, Subtask, Task, proprioception

NAME = "two_arm_pick_place_handover"
DEFAULT_ARMS = 2
ARM_COUNTS = (2,)

# So far apart that the first arm cannot reach the bin, nor the second the container: the hammer must be handed over.
_BASE_DISTANCE_M = 0.78


def task(arms: int) -> Task:
    fetcher, receiver = Arm.at(0, -_BASE_DISTANCE_M, 0.0, 0.0), Arm.at(1, _BASE_DISTANCE_M, 0.0, math.pi)
    both = (fetcher.name, receiver.name)
    return Task(
        name=NAME,
        title="Pick-place handover",
        instruction=(
            "Arm 0 takes the lid off the container and fetches the hammer, while arm 1 clears the trash cube from the "
            "bin into the small tray. Then arm 0 hands the hammer over, and arm 1 lays it into the bin."
        ),
        arms=(fetcher, receiver),
        subtasks=(
            Subtask("lid_removed", "The container is open", coordinated=False, arms=both[:1]),
            Subtask("trash_cleared", "The trash is in the small tray", coordinated=False, arms=both[1:]),
            Subtask("hammer_fetched", "The hammer is out of the container", coordinated=False, arms=both[:1]),
            Subtask("hammer_handed_over", "Arm 1 has the hammer", coordinated=True, arms=both),
            Subtask("hammer_placed", "The hammer is in the bin", coordinated=True, arms=both[1:]),
        ),
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
