from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.pose import Pose
from mart.protocol.tasks import arm_counts, task_names
from mart.sim.world import Diverged, World
from mart.sim.world.model import substeps

TASK = "two_arm_multi_cube_lifting"


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


def some_actions(ticks: int, arms: int = 2) -> NDArray[np.float64]:
    return np.random.default_rng(7).uniform(-1, 1, (ticks, arms, 7))


def roll(world: World, actions: NDArray[np.float64]) -> list[bytes]:
    states = []
    for action in actions:
        world.step(action)
        states.append(world.integration_state())
    return states


def towards_cubes(world: World, *, closing: bool) -> NDArray[np.float64]:
    """Actions that bring each tool down on its cube; shape (arms, 7)."""
    seen = world.observations()
    actions = []
    for arm in world.task.arms:
        cube = seen[f"{arm.name.replace('arm', 'cube')}/position_in_world"]
        position = arm.pose_base_in_world.inverse().transform_points(cube)
        target = Pose(position, Pose.identity().quaternion_wxyz)
        actions.append(world.action_for(arm.name, target, float(closing)))
    return np.array(actions)


def test_same_seed_and_actions_give_the_same_bytes(world: World) -> None:
    world.reset(3)
    first = [world.integration_state(), *roll(world, some_actions(40))]
    again = World.build(TASK)
    again.reset(99)
    roll(again, some_actions(5))
    again.reset(3)
    assert [again.integration_state(), *roll(again, some_actions(40))] == first


def test_seeds_differ(world: World) -> None:
    world.reset(1)
    one = world.integration_state()
    world.reset(2)
    assert world.integration_state() != one


def test_resimulating_from_any_state_gives_the_same_bytes(world: World) -> None:
    """Live (targets → actions → steps) against replay (recorded actions), through a grasp, from three points on."""
    world.reset(11)
    states = [world.integration_state()]
    taken, progress = [], []
    for tick in range(60):
        taken.append(towards_cubes(world, closing=tick > 35))
        world.step(taken[-1])
        states.append(world.integration_state())
        progress.append(world.progress())
    assert world.data.ncon > 12  # pads on cubes
    replica = World.build(TASK)
    for start in (0, 17, 45):
        replica.set_integration_state(states[start])
        assert replica.integration_state() == states[start]
        for tick in range(start, 60):
            replica.step(taken[tick])
            assert replica.integration_state() == states[tick + 1], f"from {start}, at tick {tick}"
            assert replica.progress() == progress[tick]


def test_an_action_is_the_clamped_step_over_the_limit(world: World) -> None:
    world.reset(0)
    pose = world.tool_pose_in_base("arm0")

    def action(
        shift: tuple[float, float, float], turn: tuple[float, float, float], gripper: float
    ) -> NDArray[np.float64]:
        turned = Pose.exp([0, 0, 0, *turn]) @ Pose(np.zeros(3), pose.quaternion_wxyz)
        return world.action_for("arm0", Pose(pose.position + shift, turned.quaternion_wxyz), gripper)

    assert action((0.01, 0, 0), (0, 0, 0.1), 0.0) == pytest.approx([0.2, 0, 0, 0, 0, 0.2, -1], abs=1e-6)
    assert action((0, -0.2, 0), (0, 0.6, 0), 1.0) == pytest.approx([0, -1, 0, 0, 1, 0, 1], abs=1e-6)
    assert action((0.3, 0.0, 0.3), (0, 0, 0), 0.5)[:3] == pytest.approx([0.5**0.5, 0, 0.5**0.5], abs=0.2)
    assert action((0, 0, 0), (0, 0, 0), 7.0)[6] == 1.0


def test_actions_beyond_one_are_clipped(world: World) -> None:
    world.reset(0)
    world.step(np.full((2, 7), 5.0))
    clipped = world.integration_state()
    world.reset(0)
    world.step(np.ones((2, 7)))
    assert world.integration_state() == clipped


@pytest.mark.parametrize("shape", [(7,), (1, 7), (3, 7), (2, 6), (2, 7, 1)])
def test_actions_of_a_wrong_shape_are_refused(world: World, shape: tuple[int, ...]) -> None:
    world.reset(0)
    with pytest.raises(InvalidInput):
        world.step(np.zeros(shape))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_actions_that_are_not_finite_are_refused_and_nothing_moves(world: World, bad: float) -> None:
    world.reset(0)
    before = world.integration_state()
    actions = np.zeros((2, 7))
    actions[1, 3] = bad
    with pytest.raises(InvalidInput):
        world.step(actions)
    assert world.integration_state() == before


def test_divergence_is_noticed_until_the_next_reset(
    world: World, caplog: pytest.LogCaptureFixture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    world.reset(0)
    world.step(np.zeros((2, 7)))
    world.data.qvel[3] = np.nan
    for _ in range(2):
        with pytest.raises(Diverged):
            world.step(np.zeros((2, 7)))
    assert "Nan, Inf or huge value in QVEL" in caplog.text
    assert not list(tmp_path.iterdir())  # MuJoCo would leave a log file
    world.reset(0)
    world.step(np.zeros((2, 7)))


@pytest.mark.parametrize("state", [b"", b"12345678", b"\0" * 100_000])
def test_a_state_of_another_size_is_refused(world: World, state: bytes) -> None:
    with pytest.raises(InvalidInput):
        world.set_integration_state(state)


def test_a_state_that_is_not_finite_is_refused(world: World) -> None:
    world.reset(0)
    state = np.frombuffer(world.integration_state(), "<f8").copy()
    state[4] = np.nan
    with pytest.raises(InvalidInput):
        world.set_integration_state(state.tobytes())


@pytest.mark.parametrize("name", task_names())
def test_every_task_with_every_number_of_arms_meets_its_declaration(name: str) -> None:
    for arms in arm_counts(name):
        world = World.build(name, arms=arms)
        assert world.arms == tuple(f"arm{i}" for i in range(arms))
        cameras = {world.model.camera(i).name for i in range(world.model.ncam)}
        assert set(world.task.viewpoints) <= cameras
        for seed in range(3):
            world.reset(seed)
            world.step(some_actions(1, arms)[0])
            assert_observations_as_declared(world)
            progress = world.progress()
            assert tuple(progress.subtasks) == tuple(subtask.name for subtask in world.task.subtasks)
            assert not progress.success
            assert progress.failed is None


def assert_observations_as_declared(world: World) -> None:
    seen = world.observations()
    assert list(seen) == [declared.name for declared in world.task.observations]
    for declared in world.task.observations:
        assert seen[declared.name].shape == declared.shape
        assert seen[declared.name].dtype == np.float64
        assert np.isfinite(seen[declared.name]).all()
    union: set[str] = set()
    for arm in world.arms:
        own = world.observations_for(arm)
        assert list(own) == [declared.name for declared in world.task.observations_of(arm)]
        assert all((own[name] == seen[name]).all() for name in own)
        union |= set(own)
    assert union == set(seen)


def test_arms_start_where_the_task_says_and_hold(world: World) -> None:
    starts = []
    for seed in range(20):
        world.reset(seed)
        starts.append([world.tool_pose_in_base(arm).position for arm in world.arms])
        assert (
            world.tool_pose_in_base("arm0").distance_to(
                Pose(world.tool_pose_in_base("arm0").position, Pose.identity().quaternion_wxyz)
            )[1]
            < 1e-5
        )
    spread = np.array(starts) - (0.45, 0.0, 0.20)
    assert np.abs(spread).max() <= 0.03 + 1e-6
    assert spread.std(axis=0).min() > 0.01


@pytest.mark.parametrize("arms", [2, 3, 4])
def test_nothing_touches_at_the_start_but_things_on_the_table(arms: int) -> None:
    world = World.build(TASK, arms=arms)
    for seed in range(10):
        world.reset(seed)
        names = {
            world.model.body(world.model.geom_bodyid[geom]).name
            for contact in world.data.contact[: world.data.ncon]
            for geom in contact.geom
        }
        assert all(name == "world" or name.startswith("cube") for name in names), names


def test_the_model_is_the_same_wherever_it_is_built(world: World) -> None:
    assert World.build(TASK).model_sha256 == world.model_sha256
    assert World.build(TASK, control_hz=60).model_sha256 != world.model_sha256
    assert b"site-packages" not in world.model_bytes()


@pytest.mark.parametrize("name", task_names())
def test_a_world_in_ticks_of_another_rate_is_what_would_be_built(name: str) -> None:
    built, other = World.build(name, 60.0), World.build(name, 20.0)
    changed = other.at(60.0)
    assert changed.model_sha256 == built.model_sha256
    assert changed.task is other.task
    for one in (changed, built):
        one.reset(5)
        one.step(np.full((len(one.arms), 7), 0.3))
    assert changed.integration_state() == built.integration_state()
    assert other.model_sha256 == World.build(name, 20.0).model_sha256  # what it was made from stays as it was
    with pytest.raises(InvalidInput):
        other.at(500.0)


def test_the_model_survives_the_wire(world: World) -> None:
    world.reset(4)
    copy = mujoco.MjModel.from_binary_path("room.mjb", {"room.mjb": world.model_bytes()})
    assert mujoco.mj_stateSize(copy, mujoco.mjtState.mjSTATE_INTEGRATION) * 8 == len(
        world.integration_state()
    )


@pytest.mark.parametrize(
    ("control_hz", "number", "timestep_s"),
    [(20, 25, 0.002), (30, 17, 1 / 510), (60, 9, 1 / 540), (100, 5, 0.002)],
)
def test_substeps_fill_the_control_period(control_hz: float, number: int, timestep_s: float) -> None:
    assert substeps(control_hz)[0] == number
    assert substeps(control_hz)[1] == pytest.approx(timestep_s)


@pytest.mark.parametrize("control_hz", [0, -20, 4.9, 101, float("nan"), float("inf")])
def test_a_rate_that_cannot_be_is_refused(control_hz: float) -> None:
    with pytest.raises(InvalidInput):
        World.build(TASK, control_hz=control_hz)


def test_sim_time_advances_by_one_period(world: World) -> None:
    for control_hz in (20.0, 30.0, 60.0):
        world = World.build(TASK, control_hz)
        world.reset(0)
        world.step(np.zeros((2, 7)))
        assert world.sim_time_s == pytest.approx(1 / control_hz, abs=1e-12)


def test_unknown_names_are_refused(world: World) -> None:
    with pytest.raises(NotFound):
        World.build("two_arm_multi_cube_liftin")
    with pytest.raises(InvalidInput):
        World.build(TASK, arms=7)
    with pytest.raises(NotFound):
        world.tool_pose_in_base("arm9")


def test_a_task_must_stay_done_for_the_same_time_at_every_rate(world: World) -> None:
    fine = World.build(TASK, 60.0)
    assert fine.success_hold_ticks == 3 * world.success_hold_ticks == 3 * world.task.success_hold_ticks
