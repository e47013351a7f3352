"""A small table is put together: a column each, then the tabletop by both; the paper's mixed task."""

from __future__ import annotations

import math

from mart.protocol.tasks.task import Arm, Observation, Subtask, Task, proprioception

NAME = "two_arm_table_assembly"
DEFAULT_ARMS = 2
ARM_COUNTS = (2,)

# Far enough that neither arm can do the other's part: the other's socket and knob are out of its reach.
_BASE_DISTANCE_M = 0.72


def task(arms: int) -> Task:
    placed = (Arm.at(0, -_BASE_DISTANCE_M, 0.0, 0.0), Arm.at(1, _BASE_DISTANCE_M, 0.0, math.pi))
    both = tuple(arm.name for arm in placed)
    return Task(
        name=NAME,
        title="Table assembly",
        instruction=(
            "Each of you puts the column in your arm's colour into its socket. Then lift the tabletop together, "
            "each by your own knob, and lower it onto both columns."
        ),
        arms=placed,
        subtasks=(
            *(
                Subtask(
                    f"column{i}_seated",
                    f"The {arm.color_name} column stands in its socket",
                    coordinated=False,
                    arms=(arm.name,),
                    to_do={
                        arm.name: f"Grip the {arm.color_name} column by its round neck and stand it in the "
                        f"{arm.color_name} socket."
                    },
                )
                for i, arm in enumerate(placed)
            ),
            Subtask(
                "tabletop_lifted",
                "The tabletop is up",
                coordinated=True,
                to_do={
                    arm.name: f"Grip the tabletop's {arm.color_name} knob; lift when your partner holds the other one."
                    for arm in placed
                },
            ),
            Subtask(
                "tabletop_seated",
                "The tabletop is on both columns",
                coordinated=True,
                to_do=dict.fromkeys(
                    both,
                    "Keep the tabletop level, bring it over the columns together and lower it onto them.",
                ),
            ),
        ),
        afterwards="Let go and draw your hand up.",
        observations=(
            *(o for arm in placed for o in _of_one(arm.name)),
            *_pose("table_base", both),
            *_pose("tabletop", both),
            *(
                Observation(f"{seen}/tool_position_in_world", (3,), "m", (by,))
                for seen, by in zip(both, reversed(both), strict=True)
            ),
        ),
        horizon_ticks=1800,
        trial_ticks=1200,  # a minute: practised operators need 13 s
    )


def _of_one(arm: str) -> tuple[Observation, ...]:
    return (*proprioception(arm), *_pose(arm.replace("arm", "column"), (arm,)))


def _pose(thing: str, arms: tuple[str, ...]) -> tuple[Observation, ...]:
    return (
        Observation(f"{thing}/position_in_world", (3,), "m", arms),
        Observation(f"{thing}/quaternion_in_world", (4,), "wxyz", arms),
    )
