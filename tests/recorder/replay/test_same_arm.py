"""An arm of another make, with other limits or another tool than the recorded one is refused, and it is said which."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import pytest

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import get_task
from mart.recorder.replay.same_arm import require_same_arm, require_same_kind, require_same_task

CUBES = "two_arm_multi_cube_lifting"


def arm(change: Callable[[mujoco.MjSpec], None] = lambda _: None) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body(name="arm0/base")
    for number in (1, 2):
        body = body.add_body(name=f"arm0/link{number}", pos=(0.0, 0.0, 0.3))
        body.mass, body.inertia, body.explicitinertial = 1.0, (0.01, 0.01, 0.01), True
        body.add_joint(name=f"arm0/joint{number}", axis=(0, 1, 0), range=(-2.0, 2.0))
    body.add_site(name="arm0/tool", pos=(0.0, 0.0, 0.1))
    change(spec)
    return spec.compile()


def other_range(spec: mujoco.MjSpec) -> None:
    spec.joint("arm0/joint2").range = (-1.5, 2.0)


def other_link(spec: mujoco.MjSpec) -> None:
    spec.body("arm0/link2").pos = (0.0, 0.0, 0.31)


def other_tool(spec: mujoco.MjSpec) -> None:
    spec.site("arm0/tool").pos = (0.0, 0.0, 0.15)


def one_joint_more(spec: mujoco.MjSpec) -> None:
    spec.body("arm0/link2").add_joint(name="arm0/joint3", axis=(1, 0, 0), range=(-1, 1))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (other_range, "The joint limits of arm0"),
        (other_link, "The joints of arm0"),
        (one_joint_more, "The joints of arm0"),
        (other_tool, "The mount and tool of arm0"),
    ],
)
def test_what_differs_is_named(change: Callable[[mujoco.MjSpec], None], said: str) -> None:
    require_same_arm("arm0", arm(), arm(), "room-1")
    with pytest.raises(InvalidInput, match=f"{said} are others in room-1 than when it was recorded"):
        require_same_arm("arm0", arm(), arm(change), "room-1")


def test_another_task_another_kind_and_no_such_arm_are_refused() -> None:
    cubes, mixed, tray = (
        get_task(CUBES),
        get_task(CUBES, 2, ("panda", "ur5e")),
        get_task("two_arm_drink_tray_lifting"),
    )
    with pytest.raises(InvalidInput, match="Open a room of the same task"):
        require_same_task(cubes, tray, "room-1")
    with pytest.raises(InvalidInput, match="arm1 was a panda when it was recorded; arm1 of room-1 is a ur5e"):
        require_same_kind("arm1", cubes, mixed, "room-1")
    with pytest.raises(NotFound):
        require_same_kind("arm7", cubes, mixed, "room-1")
