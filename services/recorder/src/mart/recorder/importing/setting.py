"""Tell of what task, arms and rate a data set is, from what it says. Pure."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import MAX_ARMS, Task, arm_counts, get_task, task_names
from mart.recorder.importing.foreign_episode import Setting

_RATES_HZ = (0.1, 1000.0)


def from_arguments(name: object, arguments: Mapping[str, Any]) -> Setting:
    """Read robomimic's `env_args`: MART's `control_hz`, `arms` and `arm_kinds`, or robosuite's `control_freq`."""
    arms, kinds = arguments.get("arms"), arguments.get("arm_kinds")
    return Setting(
        task=name if isinstance(name, str) and name in task_names() else None,
        arms=arms if isinstance(arms, int) and 0 < arms <= MAX_ARMS else None,
        arm_kinds=tuple(map(str, kinds.values()))
        if isinstance(kinds, dict) and len(kinds) <= MAX_ARMS
        else (),
        control_hz=rate_of(arguments.get("control_hz", arguments.get("control_freq"))),
    )


def rate_of(said: object) -> float | None:
    """Return a rate in Hz, None for what is none."""
    if isinstance(said, bool) or not isinstance(said, int | float) or not math.isfinite(said):
        return None
    return float(said) if _RATES_HZ[0] <= said <= _RATES_HZ[1] else None


def task_of(setting: Setting, wanted: str | None, actions: int) -> Task | None:
    """Return the task that episodes with so many numbers an action are of; None where they are to be looked at only.

    wanted: whose the data set is said to be, where it does not say it itself.
    Raises NotFound for an unknown task and InvalidInput where the actions are not its.
    """
    name = wanted or setting.task
    if name is None:
        return None
    arms = setting.arms or (actions // ACTION_SIZE if actions and actions % ACTION_SIZE == 0 else 0)
    if arms * ACTION_SIZE != actions:
        raise InvalidInput(
            f"an action has {actions} numbers, and {name} takes 7 an arm (a step of the tool in -1 … 1, then the "
            "gripper); leave out --task to look at it only"
        )
    return get_task(name, arms, setting.arm_kinds if name == setting.task else ())


def setting_of_robot(instruction: str, features: Mapping[str, Mapping[str, Any]], fps: float) -> Setting:
    """Return of what a data set of LeRobot's is: a task of ours where its actions are named as ours are."""
    names = features.get("action", {}).get("names")
    arms = _arms_of(names) if isinstance(names, list) else ()
    found = [
        name
        for name in (task_names() if arms else ())
        if len(arms) in arm_counts(name) and _says(name, arms, instruction)
    ]
    if len(found) != 1:
        return Setting(control_hz=rate_of(fps))
    return Setting(task=found[0], arms=len(arms), control_hz=rate_of(fps))


def _arms_of(names: list[Any]) -> tuple[str, ...]:
    """Return the arms of actions that are named `{arm}/action/{i}`, none where they are named otherwise."""
    arms = tuple(dict.fromkeys(str(name).partition("/")[0] for name in names))[:MAX_ARMS]
    ours = [f"{arm}/action/{i}" for arm in arms for i in range(ACTION_SIZE)]
    return arms if names == ours else ()


def _says(name: str, arms: tuple[str, ...], instruction: str) -> bool:
    return get_task(name, len(arms)).instruction == instruction
