"""A robot file is read, or what is wrong in it is said in a sentence that names the place."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from mart.protocol.arms import PANDA, Workspace, arm_kind, arm_kind_names, finding, load_robot_file
from mart.protocol.errors import InvalidInput, NotFound

UR5E = (Path(finding.__file__).parent / "ur5e.toml").read_text()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MART_ARMS_DIR", str(tmp_path))
    return tmp_path


def test_the_kinds_that_come_with_it() -> None:
    kinds = {name: arm_kind(name) for name in arm_kind_names()}
    assert list(kinds) == [
        "panda",
        "gen3",
        "ur5e",
        "menagerie:kinova_gen3",
        "menagerie:universal_robots_ur5e",
    ]
    assert [kind.joint_count for kind in kinds.values()] == [7, 7, 6, 7, 6]
    assert PANDA.workspace == Workspace()
    for kind in kinds.values():
        space = kind.workspace
        highest_m = max(space.z_max_m - space.reach_center_z_m, space.reach_center_z_m - space.z_min_m)
        assert space.reach_m**2 - highest_m**2 > space.radius_min_m**2  # there is room at every height
        assert all(dataclasses.asdict(kind.limits).values())


def test_a_file_of_one_s_own_is_found_by_its_name_and_read_again_when_it_changes(folder: Path) -> None:
    (folder / "mine.toml").write_text(UR5E)
    assert arm_kind_names()[3] == "mine"
    assert arm_kind("mine").title == "Universal Robots UR5e"
    (folder / "mine.toml").write_text(UR5E.replace("Universal Robots UR5e", "Mine"))
    assert load_robot_file(folder / "mine.toml").title == "Mine"


def test_the_names_that_come_with_it_cannot_be_taken(folder: Path) -> None:
    (folder / "panda.toml").write_text(UR5E)
    assert arm_kind("panda") == PANDA


@pytest.mark.parametrize("name", ["ur6e", "../panda", "/etc/passwd", "", "x" * 5000, "menagerie:"])
def test_an_unknown_name_lists_the_known_ones(name: str) -> None:
    with pytest.raises(NotFound, match=r"Known: gen3, .*panda, ur5e"):
        arm_kind(name)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[-3.1416, 3.1416]", "[-180, 180]", r"links\[3\].range_rad: .* looks like degrees"),
        ("[-3.1416, 3.1416]", "[3.1416, -3.1416]", r"links\[3\].range_rad: the lower limit comes first"),
        ("home_rad = [-0.30, ", "home_rad = [", "home_rad has 5 angles, but there are 6 joints"),
        ("2.10, -1.92", "3.50, -1.92", "home_rad puts joint 3 at 3.5 rad, outside its range"),
        ("torque_nm = 28", "torque_nm = -28", r"links\[4\].torque_nm: .* greater than 0"),
        ("mass_kg = 8.058\n", "", r"links\[2\].mass_kg: Field required"),
        ("reach_m = 0.90", "reach = 0.90", "workspace.reach: "),
        ("[mount]", "[mounts]", "mounts: there is no such key"),
        ("quaternion_wxyz = [0, 0, 0, 1]", "quaternion_wxyz = [0, 0, 0, 0]", "length 0 is no turn"),
        ('form = "capsule"', 'form = "pipe"', r"shapes.*pipe"),
        ('title = "Universal Robots UR5e"', 'title = "Universal Robots UR5e', "is not TOML"),
        ('title = "', 'name = "other"\ntitle = "', "says a name"),
        ("mass_kg = 8.058", "mass_kg = nan", r"links\[2\].mass_kg: .* finite"),
    ],
)
def test_a_mistake_is_named_with_its_place(folder: Path, old: str, new: str, words: str) -> None:
    assert old in UR5E
    file = folder / "mine.toml"
    file.write_text(UR5E.replace(old, new, 1))
    with pytest.raises(InvalidInput, match=words) as raised:
        load_robot_file(file)
    assert str(raised.value).endswith(".")
    assert str(file) in str(raised.value)


def test_too_few_joints_and_impossible_names(folder: Path) -> None:
    first, *links = UR5E.split("[[links]]")
    (folder / "short.toml").write_text("[[links]]".join([first, *links[:4]]))
    with pytest.raises(InvalidInput, match="4 links were given; 5 to 7 can be controlled"):
        load_robot_file(folder / "short.toml")
    (folder / "My Arm.toml").write_text(UR5E)
    with pytest.raises(InvalidInput, match="cannot be the name of a file that is a robot file"):
        load_robot_file(folder / "My Arm.toml")
    with pytest.raises(NotFound, match="There is no robot file"):
        load_robot_file(folder / "nothing.toml")
