"""Tell whether an arm of a room is the one that was recorded: of the same make, joints, ranges and tool."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import Task

_SAME = 1e-6  # metres, radians


def require_same_task(recorded: Task, present: Task, room: str) -> None:
    """Raise InvalidInput where a room has another task than was recorded: other things stand on its table."""
    if recorded.name != present.name:
        raise InvalidInput(
            f"{recorded.name} was recorded; {room} has {present.name}. Open a room of the same task."
        )


def require_same_kind(arm: str, recorded: Task, present: Task, room: str) -> None:
    """Raise InvalidInput where an arm of a room is of another kind than the recorded one, NotFound without one."""
    if arm not in recorded.arm_names:
        raise NotFound.named("arm of the recording", arm, recorded.arm_names)
    was, is_now = recorded.arm(arm).kind.name, present.arm(arm).kind.name
    if was != is_now:
        raise InvalidInput(f"{arm} was a {was} when it was recorded; {arm} of {room} is a {is_now}.")


def require_same_arm(arm: str, recorded: mujoco.MjModel, present: mujoco.MjModel, room: str) -> None:
    """Raise InvalidInput, naming what differs, where two compiled models have another arm of the same name."""
    was, is_now = _facts(recorded, arm), _facts(present, arm)
    for what, value in was.items():
        other = is_now[what]
        if value.shape != other.shape or float(np.abs(value - other).max(initial=0.0)) > _SAME:
            raise InvalidInput(
                f"{what} of {arm} are others in {room} than when it was recorded: another arm, or another "
                "version of its robot file."
            )


def _facts(model: mujoco.MjModel, arm: str) -> dict[str, NDArray[np.float64]]:
    joints = [i for i in range(model.njnt) if model.joint(i).name.startswith(f"{arm}/joint")]
    bodies = model.jnt_bodyid[joints]
    site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, f"{arm}/tool")
    if not joints or site < 0:
        raise InvalidInput(f"The model has no arm {arm!r}.")
    tool = np.concatenate([model.site_pos[site], model.site_quat[site]])
    return {
        "The joints": np.concatenate(
            [model.body_pos[bodies], model.body_quat[bodies], model.jnt_axis[joints]], 1
        ),
        "The joint limits": np.array(model.jnt_range[joints]),
        "The mount and tool": tool,
    }
