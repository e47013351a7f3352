"""Ways are cut at what files tell, and each part is carried by what the demonstrations agree about."""

from __future__ import annotations

import numpy as np
import pytest

from mart.protocol.tasks import get_task
from mart.recorder.multiply.composition import Composer
from mart.recorder.multiply.demonstration import Demonstration
from mart.recorder.multiply.references import TOOL, references_of, turn_order
from mart.recorder.multiply.segments import (
    CLOSES,
    DONE,
    ENDS,
    first_done,
    segments_of,
    together,
    together_from,
)
from tests.recorder.multiply.ways import CUBES, pick_and_lift


@pytest.fixture
def demonstrations() -> list[Demonstration]:
    random = np.random.default_rng(3)
    return [pick_and_lift(f"{i}.mcap", random, (i, 5 - i)) for i in range(5)]


def test_a_way_is_cut_where_the_gripper_closes_and_where_the_subtask_is_done(
    demonstrations: list[Demonstration],
) -> None:
    segments = segments_of(CUBES, demonstrations[1], "arm0")
    assert [(one.begin, one.end, one.kind.end) for one in segments] == [
        (0, 41, CLOSES),
        (41, 81, DONE),
        (81, 120, ENDS),
    ]
    assert [one.kind.step for one in segments] == ["lift_cube0", "lift_cube0", ""]


def test_segments_cover_a_way_without_gaps(demonstrations: list[Demonstration]) -> None:
    for one in demonstrations:
        for arm in CUBES.arm_names:
            segments = segments_of(CUBES, one, arm)
            assert [segments[0].begin, *(s.end for s in segments)] == [
                *(s.begin for s in segments),
                one.ticks,
            ]


def test_fingers_close_at_their_cube_and_lift_from_where_they_closed(
    demonstrations: list[Demonstration],
) -> None:
    references = references_of(Composer(CUBES, demonstrations).segments())
    frames = {(kind.arms, kind.end): reference.frame for kind, reference in references.items()}
    assert frames[("arm0",), CLOSES] == "cube0"
    assert frames[("arm1",), CLOSES] == "cube1"
    assert frames[("arm0",), DONE] == frames[("arm1",), ENDS] == TOOL


def test_one_demonstration_is_carried_by_the_nearest_thing(demonstrations: list[Demonstration]) -> None:
    references = references_of(Composer(CUBES, demonstrations[:1]).segments())
    assert {r.frame for kind, r in references.items() if kind.end == CLOSES} == {"cube0", "cube1"}


@pytest.mark.parametrize(
    ("turns", "order"),
    [
        ([0.1, 0.0, -0.1, 0.05], 1),
        ([0.0, np.pi, 0.05, np.pi - 0.05], 2),
        ([0.0, np.pi / 2, np.pi, -np.pi / 2, 0.02], 4),
        ([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], 0),
        ([], 0),
    ],
)
def test_how_often_a_thing_looks_the_same_is_told_by_the_turns_of_its_grips(
    turns: list[float], order: int
) -> None:
    assert turn_order(turns) == order


def test_arms_that_carry_together_keep_time_from_the_beginning_where_they_do_nothing_alone() -> None:
    tray = get_task("two_arm_drink_tray_lifting")
    assert together(tray) == ("arm0", "arm1")
    assert together(CUBES) == ()
    assert together(get_task("three_arm_lift_wiping")) == ("arm0", "arm1")


def test_an_arm_that_works_alone_never_joins(demonstrations: list[Demonstration]) -> None:
    one = demonstrations[0]
    assert together_from(CUBES, one, "arm0") == one.ticks
    assert first_done(one, "no such subtask") == one.ticks
