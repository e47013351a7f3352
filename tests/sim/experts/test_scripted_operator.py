"""An expert in a seat: begins anew with the world, and the same seed drives the same way."""

from __future__ import annotations

import pytest

from mart.operators.commander import SeatCommander
from mart.protocol.messages import OPERATOR_SCRIPT, ArmState, Command, State, pose_message
from mart.sim.experts import ScriptedOperator, get_skill
from mart.sim.room import room_messages
from mart.sim.world import World


@pytest.fixture(scope="module")
def world() -> World:
    world = World.build("two_arm_multi_cube_lifting")
    world.reset(1)
    return world


def commander_of(world: World, seed: int = 0) -> SeatCommander:
    operator = ScriptedOperator(world.task, "arm0", get_skill("average"), seed)
    commander = SeatCommander(operator, world.task, ("arm0",), OPERATOR_SCRIPT)
    commander.seat({"arm0": 4})
    return commander


def state_of(world: World, tick: int, episode: int, after_reset: bool) -> State:
    return State(
        boot=1,
        tick=tick,
        episode=episode,
        sim_time_s=tick * 0.05,
        arms=[
            ArmState(
                arm=arm,
                tool_in_base=pose_message(world.tool_pose_in_base(arm)),
                action=() if after_reset else [0.0] * 7,
            )
            for arm in world.arms
        ],
        observations=room_messages.observations(world.observations()),
    )


def driven(world: World, commander: SeatCommander, first_tick: int, episode: int) -> list[Command]:
    """What it says over two seconds of a world that was just reset and stands still."""
    commands = []
    for tick in range(first_tick, first_tick + 40):
        assert commander.observe(state_of(world, tick, episode, after_reset=tick == first_tick))
        commands += commander.commands(0)
    return commands


def targets(commands: list[Command]) -> list[tuple[float, float, float]]:
    return [(c.target_tool_in_base.x, c.target_tool_in_base.y, c.target_tool_in_base.z) for c in commands]


def test_it_moves_and_says_who_it_is(world: World) -> None:
    commands = driven(world, commander_of(world), 1, episode=1)
    assert {command.source for command in commands} == {OPERATOR_SCRIPT}
    assert len(set(targets(commands))) > 5


def test_an_episode_is_driven_the_same_by_whoever_has_the_seed(world: World) -> None:
    first = targets(driven(world, commander_of(world), 1, episode=7))
    assert targets(driven(world, commander_of(world), 1, episode=7)) == first
    assert targets(driven(world, commander_of(world, seed=1), 1, episode=7)) != first


def test_a_reset_makes_it_begin_anew(world: World) -> None:
    commander = commander_of(world)
    first = driven(world, commander, 1, episode=7)
    again = driven(world, commander, 100, episode=7)
    assert targets(again)[0] == pytest.approx(targets(first)[0], abs=1e-3)
