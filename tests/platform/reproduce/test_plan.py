"""Options in, steps out: each after what it needs, residuals on their base's runs."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.platform.reproduce.plan import ReproductionOptions, steps_of
from mart.platform.reproduce.sizes import ALL_TASKS, PRESETS, TABLE_MODELS, groups_of
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import get_task
from mart.runtime.skill_option import parse_people

_TABLES = ("table1", "table2", "table3")
_CUBES = ("two_arm_multi_cube_lifting",)


@given(
    st.lists(st.sampled_from(_TABLES), min_size=1, unique=True),
    st.sampled_from(sorted(PRESETS)),
    st.lists(st.sampled_from(ALL_TASKS), unique=True),
    st.lists(st.sampled_from(TABLE_MODELS["table2"]), unique=True),
    st.none() | st.integers(1, 300),
)
def test_every_step_comes_after_what_it_needs_and_makes_what_nobody_else_does(
    tables: list[str], preset: str, tasks: list[str], models: list[str], episodes: int | None
) -> None:
    options = ReproductionOptions(tuple(tables), preset, tuple(tasks), tuple(models), episodes=episodes)
    try:
        steps = steps_of(options)
    except InvalidInput:
        return
    seen: set[str] = set()
    for step in steps:
        assert set(step.after) <= seen
        assert step.name not in seen
        seen.add(step.name)
    assert len({step.result for step in steps}) == len(steps)
    assert steps_of(options) == steps


def test_table_two_is_five_tasks_of_seven_models_judged() -> None:
    steps = steps_of(ReproductionOptions(("table2",), "paper"))
    assert sum(step.kind == "eval" for step in steps) == 35
    assert all(step.seeds == (0, 1, 2, 3, 4) for step in steps if step.kind == "train")


def test_a_residual_takes_the_runs_of_its_base_also_where_nobody_asked_for_it() -> None:
    steps = steps_of(ReproductionOptions(("table2",), "fast", _CUBES, ("r-HBC",)))
    trained = {step.model: step for step in steps if step.kind == "train"}
    base = f"runs/table2/{_CUBES[0]}/d-HBC"
    assert list(trained) == ["d-HBC", "r-HBC"]
    assert base in trained["r-HBC"].command
    assert base in trained["r-HBC"].after
    assert [step.model for step in steps if step.kind == "eval"] == ["r-HBC"]


def test_a_collection_is_made_in_batches_of_other_worlds() -> None:
    steps = steps_of(ReproductionOptions(("table2",), "fast", _CUBES, ("HBC",), episodes=60))
    collected = [step for step in steps if step.kind == "collect"]
    counts = [int(step.command[step.command.index("--episodes") + 1]) for step in collected]
    assert counts == [25, 25, 10]
    assert len({step.seeds for step in collected}) == 3


@pytest.mark.parametrize("task", ALL_TASKS)
def test_every_group_has_somebody_at_each_arm(task: str) -> None:
    arms = len(get_task(task).arms)
    assert len(groups_of(task)) == (2 if arms == 3 else 3)
    for group in groups_of(task):
        names = [person.name for person in parse_people(group.people, arms)]
        assert len(set(names)) == arms
    everybody = [p.skill for group in groups_of(task) for p in parse_people(group.people, arms)]
    assert {"hasty", "careful", "impatient", "learning"} <= set(everybody)


def test_given_data_take_the_place_of_collecting_for_experienced_operators() -> None:
    options = ReproductionOptions(("table2",), "fast", _CUBES, ("HBC",), data=Path("/lab"))
    steps = steps_of(options)
    assert [step.kind for step in steps] == ["train", "eval"]
    assert f"/lab/{_CUBES[0]}" in steps[0].command


def test_what_no_table_has_is_refused() -> None:
    with pytest.raises(NotFound, match="two_arm_drink_tray_lifting"):
        steps_of(ReproductionOptions(_TABLES, "fast", ("cooking",)))
    with pytest.raises(NotFound, match="rd-HBC"):
        steps_of(ReproductionOptions(_TABLES, "fast", (), ("GPT",)))
    with pytest.raises(InvalidInput, match="none of the tasks"):
        steps_of(ReproductionOptions(("table3",), "fast", _CUBES))
