"""Worlds with arms that differ: each is measured, commanded and controlled as what it is."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from mart.protocol.arms import arm_kind_names, finding
from mart.protocol.arms.robot_file import Gains
from mart.protocol.errors import InvalidInput
from mart.protocol.pose import Pose
from mart.protocol.tasks import get_task, task_names
from mart.sim.experts.run_experts import run_experts
from mart.sim.scene.data import ChosenRows
from mart.sim.scene.scenery import add_room
from mart.sim.world import World, WorldBatch, osc
from mart.sim.world.reach import missed, require_reach
from tests.sim.world import osc_oracle

CUBES = "two_arm_multi_cube_lifting"
MIXED = ("ur5e", "panda", "gen3")  # 6, 7 and 7 joints: their rows in the data lie unevenly


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(CUBES, arms=3, kinds=MIXED)


def test_every_arm_is_measured_in_its_own_frame(world: World) -> None:
    world.reset(3)
    seen = world.observations()
    for arm in world.task.arms:
        measured = arm.pose_base_in_world @ world.tool_pose_in_base(arm.name)
        site = world.data.site(f"{arm.name}/tool")
        assert measured.position == pytest.approx(site.xpos)
        assert seen[f"{arm.name}/tool_position_in_base"] == pytest.approx(
            world.tool_pose_in_base(arm.name).position
        )
        first = int(world.model.joint(f"{arm.name}/joint1").qposadr[0])
        joints = world.data.qpos[first : first + arm.kind.joint_count]
        assert np.array_equal(seen[f"{arm.name}/joint_positions"], joints)


def test_a_batch_gives_the_same_bits_as_its_worlds_alone(world: World) -> None:
    actions = np.random.default_rng(0).uniform(-1, 1, (12, 3, 7))
    batch = WorldBatch(world, 2, threads=1)
    batch.reset([5, 6])
    for action in actions:
        batch.step(np.stack([action, action]), np.ones(2, bool))
    world.reset(6)
    for action in actions:
        world.step(action)
    assert batch.integration_states()[1].tobytes() == world.integration_state()
    told = batch.standing().observations
    for name, value in world.observations().items():
        assert np.array_equal(told[name][1], value), name


def test_uneven_rows_follow_the_data() -> None:
    rows = np.arange(24.0).reshape(2, 6, 2)
    for chosen in ([0, 2, 5], [0, 2, 4], [3], []):
        view = ChosenRows(rows, chosen)
        rows += 1.0
        assert np.array_equal(view.read(), rows[:, chosen, :])


@pytest.mark.parametrize("spread_rad", [0.1, 1.5], ids=["at work", "near singularities"])
def test_c_and_numpy_agree(world: World, spread_rad: float) -> None:
    """Where a direction is lost, it alone is damped."""
    random, lost = np.random.default_rng(1), 0
    ranges = world.model.actuator_ctrlrange.copy()
    world.model.actuator_ctrlrange[:] *= 1e6  # the oracle does not clip
    for _ in range(40):
        world.reset(int(random.integers(1000)))
        shake(world, random, spread_rad)
        mujoco.mj_forward(world.model, world.data)
        for index, arm in enumerate(world.task.arms):
            block = world.data.userdata[osc.BLOCK_SIZE * index :][: osc.BLOCK_SIZE]
            wanted, damped = osc_oracle.torques_of_any_arm(world.model, world.data, arm, block, Gains())
            lost += damped
            first = world.model.actuator(f"{arm.name}/torque1").id
            got = world.data.ctrl[first : first + arm.kind.joint_count]
            assert np.abs(got - wanted).max() <= 1e-7 * np.abs(wanted).max()
    world.model.actuator_ctrlrange[:] = ranges
    assert lost > 10 if spread_rad > 1 else lost == 0


def shake(world: World, random: np.random.Generator, spread_rad: float) -> None:
    for index, arm in enumerate(world.task.arms):
        joint, count = world.model.joint(f"{arm.name}/joint1"), arm.kind.joint_count
        low, high = world.model.jnt_range[joint.id : joint.id + count].T
        joints = world.data.qpos[int(joint.qposadr[0]) :][:count]
        joints[:] = np.clip(joints + random.normal(0, spread_rad, count), low, high)
        block = world.data.userdata[osc.BLOCK_SIZE * index :][: osc.BLOCK_SIZE]
        block[osc.COMMAND] = random.normal(0, 0.1, 7)
        block[osc.MODE] = osc.NEW_DELTA
    world.data.qvel[:] = random.normal(0, 0.5, world.model.nv)


def test_a_state_that_is_set_goes_on_to_the_same_bits(world: World) -> None:
    world.reset(1)
    action = np.full((3, 7), 0.3)
    world.step(action)
    state = world.integration_state()
    world.step(action)
    after = world.integration_state()
    world.set_integration_state(state)
    world.step(action)
    assert world.integration_state() == after


@pytest.mark.parametrize("kind", [name for name in arm_kind_names() if name != "panda" and ":" not in name])
@pytest.mark.parametrize("task", task_names())
def test_every_kind_reaches_every_task(task: str, kind: str) -> None:
    arms = len(get_task(task).arms)
    assert missed(World.build(task, kinds=(kind,) * arms)) == ()


def test_an_arm_that_is_too_short_is_refused_with_what_it_misses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MART_ARMS_DIR", str(tmp_path))
    gen3 = (Path(finding.__file__).parent / "gen3.toml").read_text()
    (tmp_path / "back.toml").write_text(gen3.replace("forward_m = 0.06", "forward_m = -0.1"))
    with pytest.raises(
        InvalidInput, match=r"arm1, a Kinova Gen3 \(back\), misses .* in Pick-place handover by"
    ):
        require_reach(World.build("two_arm_pick_place_handover", kinds=("panda", "back")))


def test_the_workspace_and_the_limits_of_each_arm_are_its_own(world: World) -> None:
    world.reset(0)
    far = Pose.exp([2.0, 0.0, 0.2, 0.0, 0.0, 0.0])
    for arm in world.task.arms:
        for _ in range(60):
            world.step(
                [
                    world.action_for(one, far if one == arm.name else world.tool_pose_in_base(one), 0.0)
                    for one in world.arms
                ]
            )
        reached = world.tool_pose_in_base(arm.name).position
        center = np.array([0.0, 0.0, arm.kind.workspace.reach_center_z_m])
        assert np.linalg.norm(reached - center) == pytest.approx(arm.kind.workspace.reach_m, abs=0.02)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("task", "kinds"),
    [
        (CUBES, ("panda", "ur5e")),
        ("two_arm_drink_tray_lifting", ("ur5e", "gen3")),
        ("two_arm_table_assembly", ("gen3", "gen3")),
        ("two_arm_pick_place_handover", ("ur5e", "panda")),
        ("three_arm_lift_wiping", ("gen3", "panda", "ur5e")),
    ],
)
def test_scripts_do_every_task_with_any_mix_of_arms(task: str, kinds: tuple[str, ...]) -> None:
    world = World.build(task, kinds=kinds)
    assert run_experts(world, seed=2, until_s=world.task.trial_limit_s).success


def test_a_pedestal_reaches_up_to_the_base_of_an_arm_that_stands_higher(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MART_ARMS_DIR", str(tmp_path))
    gen3 = (Path(finding.__file__).parent / "gen3.toml").read_text()
    (tmp_path / "high.toml").write_text(gen3.replace("forward_m = 0.06", "forward_m = 0.06\nup_m = 0.2"))
    task = get_task("two_arm_multi_cube_lifting", kinds=("panda", "high"))
    spec = mujoco.MjSpec()
    add_room(spec, task)
    tops = {round(float(geom.pos[2] + geom.size[1]), 6) for geom in spec.worldbody.geoms if geom.pos[0] > 0.6}
    assert tops == {0.2, 0.176}  # its cap, and what stands below it
