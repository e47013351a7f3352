"""Two arms carry a tray of drinks aside, a third wipes the table under it: the paper's three-arm task."""

from __future__ import annotations

import math
from dataclasses import replace

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks.task import Arm, Observation, Subtask, Task, proprioception
from mart.protocol.tasks.tray import CARRIERS, tray_observations

NAME = "three_arm_lift_wiping"
DEFAULT_ARMS = 3
ARM_COUNTS = (3,)

WIPER = "arm2"

# What operators know beside what they observe. The tray is to stand on the rack, or beyond, to be out of the way.
RACK_TOP_M = (0.0, -0.35, 0.05)  # middle of its top, in the world frame
ASIDE_Y_M = -0.27  # of the tray's middle
# Centres of the spots of dirt in the world frame, on the table, in the order of the observation `dirt/wiped`.
SPOTS_M = tuple((x / 100, y / 100) for x in range(-10, 11, 4) for y in range(-6, 7, 4))

# The carriers stand a little towards the rack, so that the tray is before them at both of its places.
_CARRIER_X_M, _CARRIER_Y_M, _WIPER_Y_M = 0.72, -0.14, 0.62

_CARRY = "Carry the tray together, level and slowly, onto the dark rack. Do not tip the drinks."
_TAKE_SPONGE = (
    "Grip the sponge by its green block and lift it; wait with it until the tray is out of the way."
)
_WIPE = "Press the sponge lightly onto the table and rub over the dirt until it is gone."

# The same for an arm whose end effector is what wipes.
_INSTRUCTION_WITH_PAD = (
    "Blue and orange carry the tray of drinks together onto the rack. "
    "Green wipes away the dirt that was under it."
)
_WAIT_WITH_PAD = "Wait beside the tray, with your pad up, until the tray is out of the way."
_WIPE_WITH_PAD = "Press your pad lightly onto the table and rub over the dirt until it is gone."
_WITH_PAD = {_TAKE_SPONGE: _WAIT_WITH_PAD, _WIPE: _WIPE_WITH_PAD}
_SPONGE = "sponge/"


def task(arms: int) -> Task:
    placed = (
        Arm.at(0, -_CARRIER_X_M, _CARRIER_Y_M, 0.0),
        Arm.at(1, _CARRIER_X_M, _CARRIER_Y_M, math.pi),
        Arm.at(2, 0.0, _WIPER_Y_M, -math.pi / 2),
    )
    assert len(placed) == arms
    names = tuple(arm.name for arm in placed)
    return Task(
        name=NAME,
        title="Lift and wipe",
        instruction="Blue and orange carry the tray of drinks together onto the rack. "
        "Green takes the sponge and wipes away the dirt that was under it.",
        arms=placed,
        subtasks=(
            Subtask(
                "lift_tray",
                "The tray is up",
                coordinated=True,
                arms=CARRIERS,
                to_do={
                    **{
                        arm.name: f"Come down onto the {arm.color_name} handle from straight above and grip it; when "
                        "your partner holds the other one, lift slowly. Do not tip the drinks."
                        for arm in placed
                        if arm.name != WIPER
                    },
                    WIPER: _TAKE_SPONGE,
                },
            ),
            Subtask(
                "carry_tray",
                "The tray is aside",
                coordinated=True,
                arms=CARRIERS,
                to_do={**dict.fromkeys(CARRIERS, _CARRY), WIPER: _TAKE_SPONGE},
            ),
            Subtask(
                "wipe_table",
                "The table is clean",
                coordinated=False,
                arms=(WIPER,),
                to_do={WIPER: _WIPE},
            ),
        ),
        afterwards="Hold still until the table is clean: the drinks must stay up.",
        observations=(
            *(o for name in names for o in proprioception(name)),
            *tray_observations(names),
            Observation("sponge/position_in_world", (3,), "m", (WIPER,)),
            Observation("sponge/quaternion_in_world", (4,), "wxyz", (WIPER,)),
            Observation("dirt/wiped", (len(SPOTS_M),), "0 dirty, 1 wiped", (WIPER,)),
        ),
        horizon_ticks=2400,  # two minutes: scripts need 12 s
        trial_ticks=840,
        fingerless=(WIPER,),
        fitted=_fitted,
    )


def wipes_itself(task: Task) -> bool:
    """Whether the wiper's end effector is what wipes: then there is no sponge to grip."""
    return not task.arm(WIPER).kind.has_fingers


def _fitted(task: Task) -> Task:
    """Leave the sponge out where the wiper wipes with what is at its end."""
    if not wipes_itself(task):
        return task
    kind = task.arm(WIPER).kind
    if kind.end_effector.wiping is None:
        raise InvalidInput(
            f"{WIPER}, a {kind.title} ({kind.name}), has no fingers for the sponge of {task.title}, and no face that "
            "wipes: give it an end effector with one of them, such as +two_finger or +wiping_pad."
        )
    subtasks = tuple(
        replace(one, to_do={arm: _WITH_PAD.get(line, line) for arm, line in one.to_do.items()})
        for one in task.subtasks
    )
    observations = tuple(o for o in task.observations if not o.name.startswith(_SPONGE))
    return replace(task, instruction=_INSTRUCTION_WITH_PAD, subtasks=subtasks, observations=observations)
