"""Two arms lift a tray of drinks by its handles: the paper's fully coordinated task."""

from __future__ import annotations

import math

from mart.protocol.tasks.task import Arm, Subtask, Task, proprioception
from mart.protocol.tasks.tray import tray_observations

NAME = "two_arm_drink_tray_lifting"
DEFAULT_ARMS = 2
ARM_COUNTS = (2,)

_BASE_DISTANCE_M = 0.72


def task(arms: int) -> Task:
    placed = (Arm.at(0, -_BASE_DISTANCE_M, 0.0, 0.0), Arm.at(1, _BASE_DISTANCE_M, 0.0, math.pi))
    assert len(placed) == arms
    names = tuple(arm.name for arm in placed)
    return Task(
        name=NAME,
        title="Drink tray lifting",
        instruction="Each of you takes the handle in your arm's colour. Lift the tray together, level, more than 10 cm "
        "above the table, and hold it there.",
        arms=placed,
        subtasks=(
            Subtask(
                "lift_tray",
                "The tray is up",
                coordinated=True,
                to_do={
                    arm.name: f"Turn your fingers across the {arm.color_name} handle and grip it; when your partner "
                    "holds the other one, lift slowly, level, more than 10 cm."
                    for arm in placed
                },
            ),
        ),
        afterwards="Hold the tray still and level.",
        observations=(*(o for name in names for o in proprioception(name)), *tray_observations(names)),
        horizon_ticks=1200,  # a minute: scripts need 5 s
        trial_ticks=340,
        success_hold_ticks=30,
    )
