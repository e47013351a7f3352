"""Who drives which arm, as the command line says it."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from mart.platform.collect.operators import (
    SeatOperators,
    parse_operators,
)
from mart.protocol.errors import InvalidInput
from mart.runtime.cli import cli

TASK = "three_arm_lift_wiping"


@pytest.fixture
def checkpoint(tmp_path: Path) -> Path:
    (tmp_path / "checkpoint.json").touch()
    return tmp_path


def test_a_script_drives_every_arm_unless_told_otherwise() -> None:
    assert parse_operators(TASK, None) == SeatOperators(("arm0", "arm1", "arm2"))


def test_a_policy_takes_all_the_arms_that_name_it(checkpoint: Path) -> None:
    policy = f"policy:{checkpoint}"
    assert parse_operators(TASK, f"{policy},script,{policy}") == SeatOperators(
        ("arm1",), {checkpoint: ("arm0", "arm2")}
    )


def test_somebody_is_left_to_begin_episodes(checkpoint: Path) -> None:
    with pytest.raises(InvalidInput, match="mart eval"):
        parse_operators(TASK, ",".join([f"policy:{checkpoint}"] * 3))


def test_policies_live_in_real_time(checkpoint: Path) -> None:
    operators = f"script,policy:{checkpoint}"
    ended = CliRunner().invoke(cli, ["collect", "--operators", operators, "--lockstep"])
    assert isinstance(ended.exception, InvalidInput)
