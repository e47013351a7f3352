"""A lab's room file stands for the options of `mart run` and `mart driver`; what is wrong in it is said, and where."""

from __future__ import annotations

import json
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from mart.protocol.errors import InvalidInput, NotFound
from mart.runtime.arm_option import arm_kinds_option
from mart.runtime.cli import cli
from mart.runtime.rate_option import room_rate_option
from mart.runtime.room_file import RoomFile, real_room_option

LAB = """
room = "lab"
task = "two_arm_multi_cube_lifting"
control_hz = 25

[[arm]]
name = "arm0"
kind = "ur5e"
driver = "my_arm.py:MyArm"
options = { address = "192.168.0.10" }
tool_speed_m_s = 0.2

[[arm]]
name = "arm1"
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "lab.toml"
    path.write_text(LAB)
    return path


@click.command()
@real_room_option
@click.option("--room", default="room-1")
@click.option("--task", default="nothing")
@arm_kinds_option
@room_rate_option
@click.option("--driver", "drivers", multiple=True)
def told(**given: object) -> None:
    click.echo(json.dumps(given))


def test_it_stands_for_the_options_of_a_run_and_what_is_given_goes_before_it(path: Path) -> None:
    said = json.loads(CliRunner().invoke(told, ["--real", str(path)]).stdout)
    assert said == {
        "room": "lab",
        "task": "two_arm_multi_cube_lifting",
        "arm_kinds": {"arm0": "ur5e"},
        "control_hz": 25.0,
        "drivers": ["arm0"],
    }
    options = ["--room", "other", "--real", str(path), "--driver", "arm1"]
    said = json.loads(CliRunner().invoke(told, options).stdout)
    assert (said["room"], said["drivers"], said["task"]) == ("other", ["arm1"], "two_arm_multi_cube_lifting")


def test_each_driver_finds_what_is_its_own(path: Path) -> None:
    file = RoomFile.read(path)
    assert file.driver_options("arm0") == {
        "room": "lab",
        "arm": "arm0",
        "driver": "my_arm.py:MyArm",
        "options": {"address": "192.168.0.10"},
        "tool_speed_m_s": 0.2,
    }
    with pytest.raises(InvalidInput, match="no driver for arm1; it has drivers for arm0: say which by --arm"):
        file.driver_options("arm1")


def test_both_commands_take_it(path: Path) -> None:
    path.write_text(LAB.replace("two_arm_multi_cube_lifting", "two_arm_nothing"))
    assert isinstance(CliRunner().invoke(cli, ["run", "--real", str(path)]).exception, NotFound)
    ended = CliRunner().invoke(cli, ["driver", "--real", str(path), "--arm", "arm0"])
    assert "my_arm.py" in str(ended.exception)  # which is not there


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (LAB.replace('"arm1"', '"arm0"'), "arm0 is there twice"),
        (LAB.replace('"arm1"', '"left"'), "wrong at arm.1.name"),
        (LAB.replace("0.2\n", "-1\n"), "wrong at arm.0.tool_speed_m_s: Input should be greater than 0"),
        (LAB + "load = 0.5\n", "arm1 has load and no driver"),
        (LAB + "speed = 1\n", "wrong at arm.1.speed"),
        ('task = "two"\n[[arm]]\nname = "arm0"\n', "no arm has a driver"),
        ("task = ", "cannot be read"),
        ("#" * 70_000, "larger than 64 KiB"),
    ],
)
def test_what_is_wrong_is_said_and_where(path: Path, wrong: str, said: str) -> None:
    path.write_text(wrong)
    with pytest.raises(InvalidInput) as refused:
        RoomFile.read(path)
    assert said in str(refused.value)
    with pytest.raises(InvalidInput, match="cannot be read"):
        RoomFile.read(path.with_name("nothing.toml"))
