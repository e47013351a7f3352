"""A short course for whoever drives for the first time: reach, turn, grip, carry, and carry together; with a score."""

from __future__ import annotations

import math

import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks.task import Arm, Ghost, Observation, Subtask, Task, proprioception

NAME = "practice_course"
DEFAULT_ARMS = 2
ARM_COUNTS = (1, 2)

# Every arm has its own stations, in this order; two arms have one more together.
OWN_STATIONS = ("reach", "turn", "grip", "carry")
TOGETHER = "carry_together"

# Where the plank is to be carried, in the world: its middle.
PLANK_GOAL_M = (0.0, -0.13, 0.14)

_BASE_DISTANCE_M = 0.72


def task(arms: int) -> Task:
    placed = (Arm.at(0, -_BASE_DISTANCE_M, 0.0, 0.0), Arm.at(1, _BASE_DISTANCE_M, 0.0, math.pi))[:arms]
    assert len(placed) == arms
    alone = arms == 1
    together = "" if alone else " Then carry the plank together."
    return Task(
        name=NAME,
        title="Practice course",
        instruction=f"Reach, turn, grip and carry, each at the things in your arm's colour.{together}",
        arms=placed,
        subtasks=(
            *(subtask for arm in placed for subtask in _own_subtasks(arm)),
            *(() if alone else (_together(placed),)),
        ),
        afterwards="You are through the course." if alone else "You are through; hold the plank still.",
        observations=tuple(o for arm in placed for o in _seen_by(arm.name, alone)),
        horizon_ticks=3600,  # three minutes: scripts need 20 s
    )


def station(name: str, arm: str) -> str:
    """The subtask of an arm's own station."""
    return f"{name}{arm.removeprefix('arm')}"


def _own_subtasks(arm: Arm) -> tuple[Subtask, ...]:
    color = arm.color_name
    titles_and_lines = {
        "reach": (
            f"The {color} hand has reached the ball",
            f"Reach: bring your fingertips to the {color} ball on its thread, and stay there for a moment.",
        ),
        "turn": (
            f"The {color} hand is turned along the bar",
            f"Turn: go to the floating {color} bar and turn your hand until one finger is on each long side of it.",
        ),
        "grip": (
            f"The {color} cube is in the hand",
            f"Grip: come down over the {color} cube from above, close the gripper, and lift it.",
        ),
        "carry": (
            f"The {color} cube lies in its dish",
            f"Carry: bring the cube into the {color} dish, open the gripper, and go up.",
        ),
    }
    return tuple(
        Subtask(station(name, arm.name), title, coordinated=False, arms=(arm.name,), to_do={arm.name: line})
        for name, (title, line) in titles_and_lines.items()
    )


def _together(arms: tuple[Arm, ...]) -> Subtask:
    return Subtask(
        TOGETHER,
        "The plank is carried over together",
        coordinated=True,
        to_do={
            arm.name: f"Carry together: grip the {arm.color_name} handle; when your partner holds the other one, bring "
            "the plank to the yellow one."
            for arm in arms
        },
        ghost=Ghost("plank", Pose(np.array(PLANK_GOAL_M), np.array([1.0, 0.0, 0.0, 0.0]))),
    )


def _seen_by(arm: str, alone: bool) -> tuple[Observation, ...]:
    number = arm.removeprefix("arm")
    own = (
        *proprioception(arm),
        Observation(f"ball{number}/position_in_world", (3,), "m", (arm,)),
        *_pose(f"bar{number}", (arm,)),
        *_pose(f"cube{number}", (arm,)),
        Observation(f"dish{number}/position_in_world", (3,), "m", (arm,)),
        Observation(f"stations{number}/done", (len(OWN_STATIONS),), "0 open, 1 done", (arm,)),
    )
    if alone:
        return own
    partner = "arm1" if arm == "arm0" else "arm0"
    return (*own, Observation(f"{partner}/tool_position_in_world", (3,), "m", (arm,)), *_of_both(arm))


def _of_both(arm: str) -> tuple[Observation, ...]:
    """What both see is declared once, with the first arm."""
    both = ("arm0", "arm1")
    if arm != both[0]:
        return ()
    handles = (Observation(f"handle{n}/position_in_world", (3,), "m", both) for n in (0, 1))
    return (Observation("plank/position_in_world", (3,), "m", both), *handles)


def _pose(thing: str, arms: tuple[str, ...]) -> tuple[Observation, ...]:
    return (
        Observation(f"{thing}/position_in_world", (3,), "m", arms),
        Observation(f"{thing}/quaternion_in_world", (4,), "wxyz", arms),
    )
