"""Arms of other people's MJCF files: what they bring, what is left behind, and what cannot be used."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from mart.protocol.errors import InvalidInput, NotFound, Unavailable
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World
from mart.sim.world.reach import missed
from tests.support.foreign_arm import ROBOT_FILE, write_foreign_arm

CUBES = "two_arm_multi_cube_lifting"
KINDS = ("theirs", "gen3")  # the same figures, from a file of each sort


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MART_ARMS_DIR", str(tmp_path))
    write_foreign_arm(tmp_path)
    return tmp_path


def test_it_moves_as_the_same_arm_of_a_robot_file_does(folder: Path) -> None:
    world = World.build(CUBES, kinds=KINDS)
    assert missed(world) == ()
    world.reset(1)
    dofs = [int(world.model.joint(f"{arm}/joint1").dofadr[0]) for arm in world.arms]
    same = [slice(dof, dof + 7) for dof in dofs]
    for parameter in (world.model.dof_damping, world.model.dof_armature, world.model.dof_frictionloss):
        assert np.array_equal(*(parameter[rows] for rows in same))
    ranges = [world.model.jnt_range[world.model.joint(f"{arm}/joint1").id :][:7] for arm in world.arms]
    assert ranges[0] == pytest.approx(ranges[1], abs=1e-4)
    assert run_experts(world, 1, until_s=world.task.trial_limit_s).success


def test_nothing_but_the_arm_comes_along(folder: Path) -> None:
    theirs, ours = (World.build(CUBES, kinds=kinds).model for kinds in (("theirs",) * 2, ("gen3",) * 2))
    for count in ("nu", "nkey", "ncam", "nlight", "nsensor", "nnumeric", "nq", "nv", "neq", "nexclude"):
        assert getattr(theirs, count) == getattr(ours, count), count
    assert theirs.nmesh == ours.nmesh
    assert theirs.opt.timestep == ours.opt.timestep
    assert b"arm.xml" not in bytes(theirs.paths)
    bodies = [number for number in range(theirs.nbody) if "/file/" in theirs.body(number).name]
    for geom in np.flatnonzero(np.isin(theirs.geom_bodyid, bodies)):
        own, others = (2, 4) if theirs.body(theirs.geom_bodyid[geom]).name.startswith("arm0") else (4, 2)
        assert theirs.geom_contype[geom] in (0, own)  # an arm never meets itself
        assert theirs.geom_conaffinity[geom] & others
        assert theirs.mat(int(theirs.geom_matid[geom])).name == "shell"


def test_it_compiles_to_the_same_bytes_wherever_it_lies(
    folder: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = World.build(CUBES, kinds=KINDS).model_sha256
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    write_foreign_arm(elsewhere)
    monkeypatch.setenv("MART_ARMS_DIR", str(elsewhere))
    assert World.build(CUBES, kinds=KINDS).model_sha256 == here


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            'file = "their/arm.xml"',
            'file = "their/leg.xml"',
            r"There is no .*leg.xml; the robot file names it",
        ),
        ('"their_4"', '"joint4"', r"no joint of arm.xml 'joint4'.* Known: their_1, "),
        ('site = "flange"', 'site = "tcp"', r"no site of arm.xml 'tcp'.* Known: flange"),
        ('"their_3", "their_4"', '"their_4", "their_3"', r"no chain from its base"),
        ("-2.1, 0.0, -0.7", "-2.1, 0.0, 0.7", r"points .* rad away from straight down"),
        ("-2.1, 0.0, -0.7", "-2.9, 0.0, -0.7", r"their_4 .* cannot be at -2.9 rad"),
        ('site = "flange"', 'site = "flange"\nremove = ["hand"]', r"no body of arm.xml 'hand'"),
    ],
)
def test_what_a_robot_file_says_wrongly_of_it(folder: Path, old: str, new: str, words: str) -> None:
    assert old in ROBOT_FILE
    (folder / "other.toml").write_text(ROBOT_FILE.replace(old, new))
    with pytest.raises((InvalidInput, NotFound), match=words):
        World.build(CUBES, kinds=("panda", "other"))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('angle="degree"', 'angle="radian"', r"their_2 .* looks like degrees"),
        (
            'range="-147.250153 147.250153"',
            'range="-2.57 2.57"',
            r"turns by 0.090 rad alone: .* degrees unless",
        ),
        ('file="part.stl"', 'file="missing.stl"', r"arm.xml cannot be loaded: .*missing.stl"),
        ('<joint name="their_1" />', '<joint name="their_1" type="slide"/>', "their_1 .* does not turn"),
        ("</mujoco>", "", r"arm.xml cannot be loaded: "),
        ("</worldbody>", "<body><freejoint/></worldbody>", r"arm.xml cannot be loaded: "),
    ],
)
def test_what_is_wrong_in_the_mjcf(folder: Path, old: str, new: str, words: str) -> None:
    mjcf = folder / "their" / "arm.xml"
    assert old in mjcf.read_text()
    mjcf.write_text(mjcf.read_text().replace(old, new))
    with pytest.raises(InvalidInput, match=words) as raised:
        World.build(CUBES, kinds=("panda", "theirs"))
    assert str(raised.value).endswith(".")
    assert "\n" not in str(raised.value)


def test_menagerie_is_asked_for_and_refused_in_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    kinds = ("panda", "menagerie:universal_robots_ur5e")
    monkeypatch.setitem(sys.modules, "mujoco_menagerie", None)
    with pytest.raises(Unavailable, match=r"pip install mart-sim\[menagerie\]"):
        World.build(CUBES, kinds=kinds)
    monkeypatch.setitem(sys.modules, "mujoco_menagerie", offline())
    with pytest.raises(Unavailable, match=r"could not be fetched .*\(no route\); connect this machine"):
        World.build(CUBES, kinds=kinds)


def offline() -> ModuleType:
    """Stand in for the package where there is no internet."""

    class MenagerieError(Exception):
        pass

    def get(_name: str) -> None:
        raise MenagerieError("no route")

    module = ModuleType("mujoco_menagerie")
    vars(module).update(MenagerieError=MenagerieError, get=get)
    return module
