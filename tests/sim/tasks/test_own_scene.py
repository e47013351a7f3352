"""Tasks from files: what a world of one does, and what is said of one that cannot be."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import InvalidInput, MartError, NotFound
from mart.protocol.tasks import arm_kinds_of, get_task
from mart.sim.world import World, WorldBatch
from mart.sim.world.beginnings import problems, require_sound_beginnings
from tests.support.drawer_demonstration import TASK_FILE, demonstrate

NAME = "two_arm_drawer"
XML = TASK_FILE.with_suffix(".xml").read_text()
TOML = TASK_FILE.read_text()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MART_TASKS_DIR", str(tmp_path))
    write(tmp_path)
    return tmp_path


def write(folder: Path, toml: str = TOML, xml: str = XML) -> None:
    (folder / f"{NAME}.toml").write_text(toml)
    (folder / f"{NAME}.xml").write_text(xml)


def replaced(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


@pytest.mark.slow
def test_two_operators_do_the_example(folder: Path) -> None:
    world = World.build(NAME)
    assert not list(problems(world))
    assert len(list(demonstrate(world, 0))) == 227
    progress = world.progress()
    assert progress.success
    assert progress.subtasks == {"open_drawer": True, "fill_drawer": True, "shut_drawer": True}


def test_a_subtask_that_stays_is_done_for_good_and_others_are_not(folder: Path) -> None:
    world = World.build(NAME)
    world.reset(0)
    world.data.joint("scene/drawer").qpos[0] = 0.12
    hold = [[0.0] * 6 + [-1.0]] * 2
    world.step(hold)
    assert world.progress().subtasks["open_drawer"]
    for _ in range(30):
        world.step(hold)  # its spring pulls it shut
    assert world.data.joint("scene/drawer").qpos[0] < 0.02
    assert world.progress().subtasks == {"open_drawer": True, "fill_drawer": False, "shut_drawer": False}
    world.reset(0)
    assert not world.progress().subtasks["open_drawer"]


def test_a_subtask_can_have_to_last(folder: Path) -> None:
    write(folder, replaced(TOML, "stays = true", "for_s = 0.2"))
    world = World.build(NAME)
    world.reset(0)
    hold = [[0.0] * 6 + [-1.0]] * 2
    seen = []
    for _ in range(6):
        world.data.joint("scene/drawer").qpos[0] = 0.125
        world.step(hold)
        seen.append(world.progress().subtasks["open_drawer"])
    assert seen == [False] * 4 + [True] * 2


def test_a_batch_gives_the_same_bits_and_the_same_flags(folder: Path) -> None:
    world = World.build(NAME)
    batch = WorldBatch(world, 2, threads=1)
    actions = np.random.default_rng(0).uniform(-1, 1, (20, 2, 2, ACTION_SIZE))
    batch.reset([3, 4])
    for action in actions:
        batch.step(action, np.ones(2, dtype=bool))
    together = batch.standing(integration_states=True)
    for index, seed in enumerate((3, 4)):
        world.reset(seed)
        for action in actions:
            world.step(action[index])
        assert together.integration_states is not None
        assert together.integration_states[index].tobytes() == world.integration_state()
        assert together.subtasks[index].tolist() == list(world.progress().subtasks.values())


def test_it_compiles_to_the_same_bytes_wherever_it_lies(
    folder: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = World.build(NAME).model_sha256
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    write(elsewhere)
    monkeypatch.setenv("MART_TASKS_DIR", str(elsewhere))
    assert World.build(NAME).model_sha256 == here


def test_arms_are_of_the_kinds_that_the_file_says_unless_others_are_chosen(folder: Path) -> None:
    write(folder, replaced(TOML, "yaw_rad = 3.14159265", 'yaw_rad = 3.14159265\nkind = "ur5e"'))
    assert arm_kinds_of(NAME, None, {}) == ("panda", "ur5e")
    assert arm_kinds_of(NAME, None, {"arm1": "panda"}) == ()
    assert get_task(NAME).arm_kinds == ()  # as messages and files mean it
    world = World.build(NAME, kinds=("panda", "ur5e"))
    assert not list(problems(world))


@pytest.mark.slow
def test_other_arms_do_it_too(folder: Path) -> None:
    world = World.build(NAME, kinds=("ur5e", "gen3"))
    assert not list(problems(world))
    for _ in demonstrate(world, 2):
        pass
    assert world.progress().success


def test_angles_are_degrees_unless_the_file_says_otherwise(folder: Path) -> None:
    hinge = '<body name="lid" pos="0 0.2 0.1"><joint name="lid" axis="1 0 0" range="0 1.5"/><geom size="0.02"/></body>'
    lid = replaced(XML, '<body name="peg"', f'{hinge}\n<body name="peg"')
    write(folder, xml=replaced(lid, 'angle="degree"', 'angle="radian"'))
    world = World.build(NAME)
    assert world.model.joint("scene/lid").range.tolist() == pytest.approx([0.0, 1.5])
    write(folder, xml=lid)  # it says that degrees are meant
    assert World.build(NAME).model.joint("scene/lid").range[1] == pytest.approx(np.radians(1.5))
    write(folder, xml=replaced(lid, '<compiler angle="degree"/>', ""))
    with pytest.raises(InvalidInput, match="degrees unless"):
        World.build(NAME)
    write(
        folder, xml=replaced(lid, 'range="0 1.5"', 'range="0 90"').replace('angle="degree"', 'angle="radian"')
    )
    with pytest.raises(InvalidInput, match="looks like degrees"):
        World.build(NAME)


@pytest.mark.parametrize(
    ("old", "new", "kind", "said"),
    [
        ('name="peg"', 'name="pin"', NotFound, r"no body of two_arm_drawer\.xml 'peg'.*'pin'|'peg'.*pin"),
        ('<joint name="drawer"', '<joint name="slide"', NotFound, "hinge or slide .* 'drawer'"),
        ("<freejoint/>", "", InvalidInput, "peg .* fixed where it is"),
        ("<mujoco ", "<mujoco", InvalidInput, "not XML"),
        (
            "</worldbody>",
            '<body name="q"><geom type="mesh" mesh="q"/></body></worldbody>',
            InvalidInput,
            "compiled",
        ),
        ("<default>", "<defaults>", InvalidInput, "not XML"),
    ],
)
def test_a_scene_without_what_the_task_names_is_refused(
    folder: Path, old: str, new: str, kind: type[MartError], said: str
) -> None:
    write(folder, xml=replaced(XML, old, new))
    with pytest.raises(MartError, match=said) as refused:
        World.build(NAME)
    assert isinstance(refused.value, kind | InvalidInput)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("x_m = [0.38, 0.46]", "x_m = [0.60, 0.62]", r"peg and cabinet begin up to \d+ mm inside each other"),
        (
            "y_m = [-0.16, -0.06]",
            "y_m = [-0.70, -0.68]",
            r"peg begins beyond every arm .* misses it by \d+ cm",
        ),
        ("at_least = 0.10", "at_least = -0.10", "The subtask open_drawer .* is done where it begins"),
        (
            "[success]\n",
            '[success]\nwhen = { is = "upright", object = "peg" }\n',
            "is done where it begins: ask in .success.",
        ),
    ],
)
def test_what_is_wrong_with_how_episodes_begin_is_said_before_a_room_opens(
    folder: Path, old: str, new: str, said: str
) -> None:
    toml = replaced(TOML, old, new)
    if "0.60" in new:
        toml = replaced(toml, "y_m = [-0.16, -0.06]", "y_m = [-0.01, 0.01]")
    write(folder, toml)
    with pytest.raises(InvalidInput) as refused:
        require_sound_beginnings(World.build(NAME))
    assert re.search(
        said.replace("peg and cabinet", "(peg and cabinet|cabinet and peg|drawer and peg)"),
        str(refused.value),
    )
