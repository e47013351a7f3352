"""Scripted operators: one command for every state, from what their arm may see."""

from __future__ import annotations

import pytest

from mart.protocol.errors import Corrupt
from mart.protocol.messages import OPERATOR_SCRIPT, ArmState, State
from mart.sim.experts import get_skill
from mart.sim.operate import ScriptedOperator, sight_of
from mart.sim.room import room_messages
from mart.sim.world import World


@pytest.fixture(scope="module")
def world() -> World:
    world = World.build("two_arm_multi_cube_lifting")
    world.reset(1)
    return world


@pytest.fixture
def operator(world: World) -> ScriptedOperator:
    return ScriptedOperator(world.task, "arm0", epoch=4, skill=get_skill("expert"), seed=0)


def state_of(world: World, tick: int, sequence: int = 0, after_reset: bool = False) -> State:
    return State(
        boot=1,
        tick=tick,
        sim_time_s=tick * 0.05,
        arms=[
            ArmState(arm=arm, sequence=sequence, action=() if after_reset else [0.0] * 7)
            for arm in world.arms
        ],
        observations=room_messages.observations(world.observations()),
    )


def test_it_says_nothing_before_it_has_seen_anything(operator: ScriptedOperator) -> None:
    assert operator.command(0) is None


def test_a_state_makes_a_command_of_its_seat(operator: ScriptedOperator, world: World) -> None:
    assert operator.see(state_of(world, 1))
    command = operator.command(77)
    assert command is not None
    assert (command.arm, command.seat_epoch, command.sequence) == ("arm0", 4, 1)
    assert (command.source, command.seen_tick, command.stamps.sent_ns) == (OPERATOR_SCRIPT, 1, 77)


def test_the_same_state_again_is_no_news(operator: ScriptedOperator, world: World) -> None:
    assert operator.see(state_of(world, 1))
    assert not operator.see(state_of(world, 1))


def test_a_repeat_says_the_same_under_a_higher_number(operator: ScriptedOperator, world: World) -> None:
    operator.see(state_of(world, 1))
    first, second = operator.command(1), operator.command(2)
    assert first is not None
    assert second is not None
    assert second.sequence == first.sequence + 1
    assert second.target_tool_in_base == first.target_tool_in_base


def test_it_counts_on_from_what_was_used_before(operator: ScriptedOperator, world: World) -> None:
    operator.see(state_of(world, 1, sequence=500))
    command = operator.command(0)
    assert command is not None
    assert command.sequence == 501


def test_a_reset_makes_it_begin_anew(operator: ScriptedOperator, world: World) -> None:
    targets = []
    for first_tick in (1, 100):
        for tick in range(first_tick, first_tick + 10):
            operator.see(state_of(world, tick, after_reset=tick == first_tick))
        command = operator.command(0)
        assert command is not None
        targets.append(command.target_tool_in_base)
    assert targets[0].z == pytest.approx(targets[1].z, abs=1e-3)


def test_it_sees_its_own_arm_only(world: World) -> None:
    visible = world.task.observations_of("arm0")
    sight = sight_of(state_of(world, 1), visible)
    assert set(sight) == set(world.observations_for("arm0"))
    assert not any(name.startswith(("arm1", "cube1")) for name in sight)


@pytest.mark.parametrize("spoil", ["missing", "short"])
def test_a_state_that_does_not_show_enough_is_refused(
    operator: ScriptedOperator, world: World, spoil: str
) -> None:
    state = state_of(world, 1)
    if spoil == "missing":
        del state.observations[0]
    else:
        del state.observations[0].value[0]
    with pytest.raises(Corrupt):
        operator.see(state)


def test_a_state_without_its_arm_is_refused(operator: ScriptedOperator, world: World) -> None:
    state = state_of(world, 1)
    del state.arms[:]
    with pytest.raises(Corrupt, match="arm0"):
        operator.see(state)
