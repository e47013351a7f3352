"""Carried ways: the demonstration itself where nothing moved, and at the thing wherever that lies."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.recorder.multiply.carried_segment import Placed, shares_led_over
from mart.recorder.multiply.composition import Composer
from mart.recorder.multiply.demonstration import Demonstration, ToolInWorld
from mart.recorder.multiply.references import references_of
from mart.recorder.multiply.segments import CLOSES
from mart.recorder.multiply.transport import carried, yaw_quaternion
from mart.recorder.multiply.way_player import WayPlayer
from tests.recorder.multiply.ways import CUBES, done, pick_and_lift, placed

RANDOM = np.random.default_rng(11)
DEMONSTRATIONS = [pick_and_lift(f"{i}.mcap", RANDOM, (2 * i, 10 - 2 * i)) for i in range(5)]
COMPOSER = Composer(CUBES, DEMONSTRATIONS)
REFERENCES = references_of(COMPOSER.segments())
SUBTASKS = [one.name for one in CUBES.subtasks]
_MOST_TICKS = 600


def player(one: Demonstration, start: dict[str, ToolInWorld], things: dict[str, Placed]) -> WayPlayer:
    pieces = Composer(CUBES, [one]).compose(things, np.random.default_rng(0))
    return WayPlayer(CUBES, pieces, REFERENCES, start)


def starts(one: Demonstration) -> dict[str, ToolInWorld]:
    return {arm: way.start for arm, way in one.ways.items()}


@pytest.mark.parametrize("one", DEMONSTRATIONS, ids=lambda one: one.name)
def test_in_its_own_world_a_demonstration_is_led_as_it_was(one: Demonstration) -> None:
    playing = player(one, starts(one), placed(one, 0))
    for tick in range(one.ticks):
        targets = playing.targets(placed(one, tick), done(one, tick))
        for arm, target in targets.items():
            assert np.allclose(target.position, one.ways[arm].positions[tick], atol=1e-9)
            assert np.allclose(target.quaternion, one.ways[arm].quaternions[tick], atol=1e-9)
            assert target.gripper == one.ways[arm].grippers[tick]
    assert playing.done


@settings(max_examples=20, deadline=None)
@given(
    shift=st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)),
    turn=st.floats(-0.7, 0.7),
    index=st.integers(0, len(DEMONSTRATIONS) - 1),
)
def test_fingers_close_where_the_thing_lies_and_no_step_is_longer_than_shown(
    shift: tuple[float, float], turn: float, index: int
) -> None:
    one = DEMONSTRATIONS[index]
    then = placed(one, 0)
    now = {
        name: Placed(p.position + np.array([*shift, 0.0]), (p.yaw_rad or 0.0) + turn)
        for name, p in then.items()
    }
    playing = player(one, starts(one), now)
    last = {arm: way.start.position for arm, way in one.ways.items()}
    closed: dict[str, np.ndarray] = {}
    for _ in range(_MOST_TICKS):
        targets = playing.targets(now, SUBTASKS)
        for arm, target in targets.items():
            step_m = float(np.linalg.norm(target.position - last[arm]))
            assert step_m <= CUBES.arm(arm).kind.limits.step_m
            if target.gripper > 0.5:
                closed.setdefault(arm, last[arm])
            last[arm] = target.position
        if playing.done:
            break
    assert playing.done
    for arm, at in closed.items():
        cube = arm.replace("arm", "cube")
        segment = next(s for p in playing.pieces[arm] for s in p.segments if s.kind.end == CLOSES)
        shown = one.ways[arm].positions[segment.end - 1]
        wanted = carried(shown, then[cube].position, now[cube].position, turn)
        assert np.allclose(at, wanted, atol=1e-6)


def test_arms_that_work_alone_may_follow_different_demonstrations() -> None:
    things = placed(DEMONSTRATIONS[0], 0)
    drawn = set()
    for seed in range(20):
        pieces = COMPOSER.compose(things, np.random.default_rng(seed))
        drawn.add(tuple(own[0].demonstration.name for own in pieces.values()))
    assert any(first != second for first, second in drawn)


def test_the_same_seed_draws_the_same() -> None:
    things = placed(DEMONSTRATIONS[2], 0)
    first, again = (COMPOSER.compose(things, np.random.default_rng(5)) for _ in range(2))
    assert first == again


@given(st.integers(2, 60), st.booleans(), st.floats(0.0, 0.02))
def test_a_path_is_led_over_from_nothing_to_all_and_never_back(
    ticks: int, in_contact: bool, step_m: float
) -> None:
    path = np.outer(np.arange(ticks), np.array([step_m, 0.0, 0.0]))
    shares = shares_led_over(path, in_contact=in_contact)
    assert (np.diff(shares) >= 0.0).all()
    assert shares[0] == 0.0
    assert shares[-1] == 1.0


def test_a_tool_that_began_elsewhere_comes_to_the_thing_all_the_same() -> None:
    one = DEMONSTRATIONS[0]
    begun = {
        arm: ToolInWorld(start.position + 0.03, yaw_quaternion(0.1), 0.0)
        for arm, start in starts(one).items()
    }
    playing, targets = player(one, begun, placed(one, 0)), begun
    for tick in range(38):
        targets = playing.targets(placed(one, tick), SUBTASKS)
    assert np.allclose(targets["arm0"].position, one.ways["arm0"].positions[37], atol=1e-6)
