from __future__ import annotations

import pytest

from mart.protocol import errors


def test_a_wrong_name_lists_the_right_ones_and_guesses() -> None:
    error = errors.NotFound.named("task", "two_arm_lift", ["two_arm_lifting", "handover"])
    assert str(error) == (
        "There is no task 'two_arm_lift'. Did you mean 'two_arm_lifting'? Known: handover, two_arm_lifting."
    )
    assert "Did you mean" not in str(errors.NotFound.named("task", "zzz", ["a"]))


@pytest.mark.parametrize("branch", errors.BRANCHES.values())
def test_every_branch_comes_back_from_the_wire(branch: type[errors.MartError]) -> None:
    error = errors.from_wire(branch("x").code, "x")
    assert type(error) is branch
    assert str(error) == "x"


def test_an_unknown_code_becomes_the_root() -> None:
    assert type(errors.from_wire("Weird", "x")) is errors.MartError
