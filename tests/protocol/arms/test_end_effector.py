"""What an arm holds at its end is a file, and is named after its kind and a plus sign."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.protocol.arms import PANDA, arm_kind, end_effector, end_effector_names, finding, load_robot_file
from mart.protocol.errors import InvalidInput, NotFound

HERE = Path(finding.__file__).parent
UR5E = (HERE / "ur5e.toml").read_text()
PAD = (HERE / "end_effectors" / "wiping_pad.toml").read_text()
GRIPPER = (HERE / "end_effectors" / "robotiq_2f85.toml").read_text()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MART_ARMS_DIR", str(tmp_path))
    (tmp_path / "end_effectors").mkdir()
    return tmp_path


def test_those_that_come_with_it() -> None:
    assert end_effector_names() == ("two_finger", "robotiq_2f85", "wiping_pad")
    about = {name: end_effector(name).about for name in end_effector_names()}
    assert about == {
        "two_finger": "two fingers, 80 mm, 30 N",
        "robotiq_2f85": "two fingers, 85 mm, 40 N",
        "wiping_pad": "no fingers, wipes",
    }


def test_a_kind_with_something_else_at_its_end_is_a_kind_of_its_own() -> None:
    kind = arm_kind("ur5e+robotiq_2f85")
    assert (kind.name, kind.title) == ("ur5e+robotiq_2f85", "Universal Robots UR5e with Robotiq 2F-85")
    assert kind.has_fingers
    assert not arm_kind("menagerie:kinova_gen3+wiping_pad").has_fingers
    usual = arm_kind("ur5e")
    longer_m = kind.end_effector.tool_z_m - usual.end_effector.tool_z_m
    sunk_m = usual.workspace.reach_center_z_m - kind.workspace.reach_center_z_m
    assert sunk_m == pytest.approx(longer_m)
    assert (
        0.01 < kind.placement.forward_m - usual.placement.forward_m < 0.03
    )  # it reaches less far over the table
    assert (kind.links, kind.home_rad, kind.limits) == (usual.links, usual.home_rad, usual.limits)
    assert arm_kind("ur5e+wiping_pad").placement == usual.placement  # as long as what it has otherwise


def test_what_a_kind_has_anyway_makes_no_other_kind() -> None:
    assert arm_kind("panda+two_finger") == PANDA
    assert PANDA.end_effector == end_effector("two_finger")


def test_a_robot_file_names_its_own_and_the_plus_sign_overrides_it(folder: Path) -> None:
    (folder / "wiper.toml").write_text(f'end_effector = "wiping_pad"\n{UR5E}')
    assert not arm_kind("wiper").has_fingers
    assert arm_kind("wiper+wiping_pad").name == "wiper"
    assert arm_kind("wiper+two_finger").has_fingers
    (folder / "wiper.toml").write_text(f'end_effector = "spoon"\n{UR5E}')
    with pytest.raises(
        InvalidInput, match=r"end_effector: There is no end effector 'spoon'. Known: robotiq_2f85"
    ):
        load_robot_file(folder / "wiper.toml")


def test_one_of_one_s_own_is_found_and_read_again_when_it_changes(folder: Path) -> None:
    file = folder / "end_effectors" / "mop.toml"
    file.write_text(PAD)
    (folder / "wiper.toml").write_text(f'end_effector = "mop"\n{UR5E}')
    assert end_effector_names()[3] == "mop"
    assert arm_kind("wiper").end_effector.title == "Wiping pad"
    file.write_text(PAD.replace("Wiping pad", "Mop of mine"))
    assert arm_kind("ur5e+mop").title == "Universal Robots UR5e with Mop of mine"
    assert arm_kind("wiper").end_effector.title == "Mop of mine"


@pytest.mark.parametrize("name", ["ur5e+spoon", "ur5e+", "ur5e+../wiping_pad", "ur5e+wiping_pad+two_finger"])
def test_an_unknown_one_lists_the_known_ones(name: str) -> None:
    with pytest.raises(
        NotFound, match=r"There is no end effector .* Known: robotiq_2f85, two_finger, wiping_pad"
    ):
        arm_kind(name)


@pytest.mark.parametrize(
    ("text", "old", "new", "words"),
    [
        (PAD, "below_tool_m = 0.015", "below_tool_m = 0.001", r"wiping.below_tool_m: .* 0.01"),
        (PAD, "mass_kg = 0.35", "mass_kg = -1", r"mass_kg: .* greater than 0"),
        (PAD, "[wiping]", "[wipes]", "wipes: there is no such key"),
        (GRIPPER, "opening_m = 0.085", "opening_m = 85", r"fingers.opening_m: .* 0.3"),
        (GRIPPER, "force_n = 40\n", "", "fingers.force_n: Field required"),
        (GRIPPER, "tool_z_m = 0.150", "tool_z_m = nan", "tool_z_m: .*"),
    ],
)
def test_a_mistake_is_named_with_its_place(folder: Path, text: str, old: str, new: str, words: str) -> None:
    assert old in text
    file = folder / "end_effectors" / "mine.toml"
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(InvalidInput, match=words) as raised:
        arm_kind("ur5e+mine")
    assert str(file) in str(raised.value)
