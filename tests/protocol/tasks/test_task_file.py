"""Task files: what each mistake is told as, and where files are looked for."""

from __future__ import annotations

import contextlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import get_task, is_in_catalogue, recorded_task, task_called, task_names
from mart.protocol.tasks.own_tasks import load_task_file, read_task_file

NAME = "push"
TEXT = """
title = "Push"
instruction = "Push the block into the corner."
[scene]
mjcf = "push.xml"
[[arms]]
x_m = -0.7
y_m = 0.0
[[objects]]
name = "block"
spawn = { x_m = [-0.1, 0.1], y_m = [0.0, 0.1] }
[[regions]]
name = "corner"
center_m = [0.1, 0.2, 0.0]
half_m = [0.1, 0.1, 0.1]
[[subtasks]]
name = "push_block"
title = "The block is in the corner"
when = { is = "inside", object = "block", region = "corner" }
to_do = { arm0 = "Push it." }
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MART_TASKS_DIR", str(tmp_path / "tasks"))
    monkeypatch.setenv("MART_TASK_FILES", "")
    (tmp_path / "tasks").mkdir()
    return tmp_path / "tasks"


def test_what_a_file_says_is_a_row_as_any_other(folder: Path) -> None:
    (folder / f"{NAME}.toml").write_text(TEXT)
    assert task_names()[-1] == NAME
    assert not is_in_catalogue(NAME)
    task = get_task(NAME)
    assert (task.arm_names, task.time_limit_s, task.trial_limit_s) == (("arm0",), 60.0, 60.0)
    assert task.success_hold_at(20.0) == 10
    assert [o.name for o in task.observations][-2:] == [
        "block/position_in_world",
        "block/quaternion_in_world",
    ]
    assert task.next_step("arm0", ()) == task.subtasks[0]
    assert recorded_task(NAME, TEXT.encode()).observations == task.observations
    with pytest.raises(InvalidInput, match="3 arms"):
        get_task(NAME, 3)


def test_a_file_that_was_given_is_known_by_its_name_before_one_of_the_folder(
    folder: Path, tmp_path: Path
) -> None:
    (folder / f"{NAME}.toml").write_text(TEXT)
    (tmp_path / f"{NAME}.toml").write_text(TEXT.replace('"Push"', '"Push it"'))
    assert get_task(NAME).title == "Push"
    assert task_called(str(tmp_path / f"{NAME}.toml")) == NAME
    assert get_task(NAME).title == "Push it"
    assert task_called(str(tmp_path / f"{NAME}.toml")) == NAME  # as often as one likes
    with pytest.raises(InvalidInput, match="Two files"):
        task_called(str(folder / f"{NAME}.toml"))


def test_names_are_no_paths(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "secret.toml").write_text(TEXT)
    for name in ("../secret", "../secret.toml", str(tmp_path / "secret"), "", "a/b", "x" * 500):
        with pytest.raises(NotFound):
            get_task(name)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("title =", "titel =", "titel: there is no such key"),
        ('title = "Push"\n', "", "title: Field required"),
        ("x_m = -0.7", "x_m = -70", r"arms\[1\]\.x_m"),
        ("x_m = -0.7", "x_m = nan", r"arms\[1\]\.x_m"),
        ("y_m = 0.0\n", "y_m = 0.0\nyaw_rad = 90\n", r"arms\[1\]\.yaw_rad"),
        ("[-0.1, 0.1]", "[0.1, -0.1]", r"objects\[1\]\.spawn\.x_m: the lower bound comes first"),
        ("{ x_m", '{ frame = "arm1", x_m', "frame 'arm1', which there is not; there is world, arm0"),
        ('object = "block"', 'object = "brick"', "object 'brick', which there is not; there is block"),
        ('region = "corner"', 'region = "edge"', "region 'edge'"),
        ("arm0 =", "arm7 =", "arm 'arm7'"),
        ('"inside"', '"within"', r"subtasks\[1\]\.when\[1\].*'inside', 'above'"),
        ('region = "corner"', 'region = "corner", z_m = 1', r"z_m: there is no such key"),
        ("[scene]", 'name = "x"\n[scene]', "leave the line out"),
        ("[[arms]]", "[[arms", "not TOML"),
        ("[[regions]]", '[[objects]]\nname = "block"\n[[regions]]', "two objects are called 'block'"),
        (
            "[[regions]]",
            "[cameras.arm9]\nposition_m=[1,1,1]\ntarget_m=[0,0,0]\n[[regions]]",
            "viewpoint 'arm9'",
        ),
        ("[[regions]]", "[cameras.front]\nposition_m=[0,0,1]\ntarget_m=[0,0,0]\n[[regions]]", "straight"),
    ],
)
def test_each_mistake_is_a_sentence_with_its_place(old: str, new: str, said: str) -> None:
    assert old in TEXT
    with pytest.raises(InvalidInput, match=said) as refused:
        read_task_file(NAME, TEXT.replace(old, new, 1), "push.toml")
    assert str(refused.value).startswith("push.toml ")
    assert str(refused.value).endswith(".")


def test_files_of_other_names_and_sizes_are_refused(folder: Path) -> None:
    for name, text in (("Push it.toml", TEXT), ("big.toml", TEXT + "#" * 70_000)):
        (folder / name).write_text(text)
        with pytest.raises(InvalidInput):
            load_task_file(folder / name)
    (folder / "bytes.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(InvalidInput, match="UTF-8"):
        load_task_file(folder / "bytes.toml")
    (folder / "two_arm_multi_cube_lifting.toml").write_text(TEXT)
    with pytest.raises(InvalidInput, match="comes with MART"):
        task_called(str(folder / "two_arm_multi_cube_lifting.toml"))
    assert get_task("two_arm_multi_cube_lifting").file is None


@given(st.integers(0, len(TEXT)), st.text(max_size=6))
def test_whatever_is_in_a_file_it_is_a_task_or_a_sentence(at: int, what: str) -> None:
    with contextlib.suppress(InvalidInput):
        assert read_task_file(NAME, TEXT[:at] + what + TEXT[at + len(what) :], "push.toml").name == NAME


def test_an_arm_may_have_a_part_without_fingers(folder: Path) -> None:
    alone = TEXT.replace("y_m = 0.0\n", "y_m = 0.0\nfingers = false\n", 1)
    (folder / f"{NAME}.toml").write_text(TEXT)
    with pytest.raises(InvalidInput, match="has no fingers"):
        get_task(NAME, 1, ("panda+wiping_pad",))
    (folder / f"{NAME}2.toml").write_text(alone)
    assert get_task(f"{NAME}2", 1, ("panda+wiping_pad",)).arms[0].kind.has_fingers is False
    held = alone.replace(
        'is = "inside", object = "block", region = "corner"', 'is = "held", object = "block", by = "arm0"'
    )
    with pytest.raises(InvalidInput, match="arm0 holds something"):
        read_task_file(f"{NAME}3", held, "held.toml")
