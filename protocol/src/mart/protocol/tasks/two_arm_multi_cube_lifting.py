"""Each arm lifts its own cube: the paper's fully decoupled task."""

from __future__ import annotations

import math

from mart.protocol.tasks.task import Arm, Observation, Subtask, Task, proprioception

NAME = "two_arm_multi_cube_lifting"
DEFAULT_ARMS = 2
ARM_COUNTS = (2, 3, 4)

# Two arms face each other along x; a third and a fourth stand at the other two sides. 0.72 m keeps the work between
# 0.40 and 0.70 m from each base, where joint limits and singularities are far.
_BASE_DISTANCE_M = 0.72
_SIDES = ((-1, 0, 0.0), (1, 0, math.pi), (0, 1, -math.pi / 2), (0, -1, math.pi / 2))


def task(arms: int) -> Task:
    placed = tuple(
        Arm.at(i, _BASE_DISTANCE_M * x, _BASE_DISTANCE_M * y, yaw)
        for i, (x, y, yaw) in enumerate(_SIDES[:arms])
    )
    return Task(
        name=NAME,
        title="Multi-cube lifting",
        instruction="Each of you picks up the cube in your arm's colour and holds it more than 10 cm above the table.",
        arms=placed,
        subtasks=tuple(
            Subtask(
                f"lift_cube{i}",
                f"The {arm.color_name} cube is up",
                coordinated=False,
                arms=(arm.name,),
                to_do={arm.name: f"Grip the {arm.color_name} cube from above and lift it more than 10 cm."},
            )
            for i, arm in enumerate(placed)
        ),
        afterwards="Hold the cube up until all of them are.",
        observations=tuple(o for arm in placed for o in (*proprioception(arm.name), *_cube(arm.name))),
        horizon_ticks=1200,  # a minute: scripts need 4 s, people at a keyboard half a minute
        trial_ticks=210,
    )


def _cube(arm: str) -> tuple[Observation, ...]:
    cube = arm.replace("arm", "cube")
    return (
        Observation(f"{cube}/position_in_world", (3,), "m", (arm,)),
        Observation(f"{cube}/quaternion_in_world", (4,), "wxyz", (arm,)),
    )
