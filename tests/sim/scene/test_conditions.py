"""Each condition of a task file: where it holds, and where it does not."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.protocol.pose import Pose
from mart.sim.world import World

XML = """<mujoco><worldbody>
  <body name="cube" pos="0 0 0.02"><freejoint/><geom type="box" size=".02 .02 .02" mass=".1"/></body>
  <body name="post" pos="0.2 0.2 0"><geom type="cylinder" size=".02 .05" pos="0 0 .05"/></body>
</worldbody></mujoco>"""
CONDITIONS = {
    "in_world": '{ is = "inside", object = "cube", region = "spot" }',
    "high": '{ is = "above", object = "cube", z_m = 0.1 }',
    "low": '{ is = "below", object = "cube", z_m = 0.03 }',
    "beside": '{ is = "near", object = "cube", other = "post", within_m = 0.1 }',
    "upright": '{ is = "upright", object = "cube" }',
    "still": '{ is = "still", object = "cube" }',
    "held": '{ is = "held", object = "cube", by = "arm0" }',
    "released": '{ is = "released", object = "cube" }',
    "still_and_low": '[{ is = "still", object = "cube" }, { is = "below", object = "cube", z_m = 0.03 }]',
}
HEAD = """
title = "Conditions"
instruction = "None."
scene = { mjcf = "conditions.xml" }
arms = [{ x_m = -0.6, y_m = 0.0 }]
objects = [{ name = "cube" }, { name = "post" }]
regions = [{ name = "spot", center_m = [0.0, 0.1, 0.02], half_m = [0.05, 0.05, 0.05] }]
"""


def built(folder: Path, head: str, *left_out: str, kinds: tuple[str, ...] = ()) -> World:
    (folder / "conditions.xml").write_text(XML)
    subtasks = "".join(
        f'[[subtasks]]\nname = "{name}"\ntitle = "{name}"\nwhen = {when}\n'
        for name, when in CONDITIONS.items()
        if name not in left_out
    )
    (folder / "conditions.toml").write_text(head + subtasks)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MART_TASKS_DIR", str(folder))
        return World.build("conditions", kinds=kinds)


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> World:
    return built(tmp_path_factory.mktemp("tasks"), HEAD)


def holding(world: World) -> set[str]:
    return {name for name, holds in world.progress().subtasks.items() if holds}


def put(world: World, position: tuple[float, float, float], *turn: float) -> None:
    world.reset(0)
    world.data.joint("scene/cube").qpos[:] = (*position, *(turn or (1.0, 0.0, 0.0, 0.0)))
    world.set_integration_state(world.integration_state())


RESTING = {"low", "upright", "still", "released", "still_and_low"}


def test_where_a_thing_is(world: World) -> None:
    put(world, (0.0, 0.0, 0.02))
    assert holding(world) == RESTING
    put(world, (0.02, 0.12, 0.02))
    assert holding(world) == RESTING | {"in_world"}
    put(world, (0.2, 0.25, 0.02))
    assert holding(world) == RESTING | {"beside"}
    put(world, (0.0, 0.0, 0.3))
    assert holding(world) == {"high", "upright", "still", "released"}
    put(world, (0.0, 0.0, 0.02), 0.9, 0.436, 0.0, 0.0)
    assert holding(world) == RESTING - {"upright"}


def test_what_moves_is_not_still(world: World) -> None:
    put(world, (0.0, 0.0, 0.02))
    world.data.joint("scene/cube").qvel[0] = 0.05
    assert holding(world) == RESTING - {"still", "still_and_low"}


def test_what_is_in_a_hand_is_held_and_not_released(world: World) -> None:
    put(world, (0.0, 0.0, 0.02))
    goal = Pose(
        world.task.arm("arm0").pose_base_in_world.inverse().transform_points((0.0, 0.0, 0.02)),
        Pose.identity().quaternion_wxyz,
    )
    for ticks, gripper in ((50, 0.0), (12, 1.0)):
        for _ in range(ticks):
            world.step([world.action_for("arm0", goal, gripper)])
        assert ("held" in holding(world)) == (gripper == 1.0)
        assert "released" not in holding(world)


def test_an_arm_without_fingers_is_beside_things_and_holds_none(tmp_path: Path) -> None:
    head = HEAD.replace("y_m = 0.0 }]", "y_m = 0.0, fingers = false }]")
    world = built(tmp_path, head, "held", kinds=("panda+wiping_pad",))
    put(world, (0.0, 0.0, 0.02))
    assert holding(world) == RESTING
    put(world, tuple(world.data.site("arm0/tool").xpos))
    assert "released" not in holding(world)
