"""`mart arms` lists, shows and checks kinds of arms."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from mart.protocol.arms import finding
from mart.sim.arm_check import ArmFinding, verdict
from mart.sim.arm_cli import arms

UR5E = (Path(finding.__file__).parent / "ur5e.toml").read_text()


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MART_ARMS_DIR", str(tmp_path))
    return tmp_path


def run(*words: str) -> Result:
    return CliRunner().invoke(arms, words, catch_exceptions=False)


def test_all_kinds_are_listed_one_that_cannot_be_used_with_the_reason(folder: Path) -> None:
    (folder / "broken.toml").write_text("title = 'Broken'")
    lines = run("list").output.splitlines()
    assert any(line.startswith("ur5e") and "Universal Robots UR5e, 6 joints" in line for line in lines)
    assert any(line.startswith("broken") and "home_rad: Field required" in line for line in lines)
    assert lines[-1] == f"Robot files of your own: {folder}"
    told = json.loads(run("list", "--json").output)
    held = {one["name"]: one["fingers"] for one in told["end_effectors"]}
    assert held == {"two_finger": True, "robotiq_2f85": True, "wiping_pad": False}
    told = told["arms"]
    assert told[0] == {"name": "panda", "title": "Franka Emika Panda, 7 joints", "joints": 7}


@pytest.mark.parametrize("name", ["panda", "ur5e", "menagerie:kinova_gen3", "gen3+wiping_pad"])
def test_a_kind_is_shown(name: str) -> None:
    assert "workspace" in run("show", name).output
    assert json.loads(run("show", name, "--json").output)["name"] == name


@pytest.mark.slow
def test_an_arm_that_can_be_used_and_one_that_cannot(folder: Path) -> None:
    good = run("check", "ur5e", "--pictures", str(folder / "pictures"))
    assert good.exit_code == 0
    assert "It can be used in every task." in good.output
    pictures = [*(folder / "pictures").iterdir()]
    assert [picture.read_bytes()[:4] for picture in pictures] == [b"\x89PNG"] * 2
    (folder / "short.toml").write_text(
        UR5E.replace("[mount]", "[placement]\nforward_m = -0.3\n\n[mount]").replace("= 0.90", "= 0.60")
    )
    short = run("check", str(folder / "short.toml"))
    assert short.exit_code == 1
    assert "BAD  reach        Pick-place handover: arm0 misses" in short.output


@pytest.mark.slow
def test_an_arm_without_fingers_is_looked_at_where_it_can_be_used(folder: Path) -> None:
    checked = run("check", "ur5e+wiping_pad", "--pictures", str(folder / "pictures"))
    assert checked.exit_code == 0
    assert "Lift and wipe: scripts did it" in checked.output
    assert "Table assembly: it has no fingers to grip with" in checked.output
    assert "It can be used in 1 of 6 tasks." in checked.output
    names = {picture.name for picture in (folder / "pictures").iterdir()}
    assert names == {"ur5e-wiping_pad-front.png", "ur5e-wiping_pad-arm2.png"}


def test_the_verdict_is_in_words() -> None:
    fine, far = ArmFinding("loads", ok=True, said=""), ArmFinding("reach", ok=False, said="")
    near, weak = ArmFinding("reach", ok=True, said=""), ArmFinding("payload", ok=False, said="")
    assert verdict([fine, near]) == "It can be used in every task."
    assert verdict([fine, near, far]) == "It can be used in 1 of 2 tasks."
    assert verdict([fine, weak, far]) == "It can be used, but look at what is marked BAD."
    assert (
        verdict([ArmFinding("loads", ok=False, said="")])
        == "It cannot be used as it is: mend what is marked BAD."
    )
