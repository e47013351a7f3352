"""A task takes any mix of arms, and says it as files and messages do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mart.protocol.arms import finding
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import Model, RoomStatus, Seat
from mart.protocol.recording import EpisodeRecord, RoomRecord
from mart.protocol.room_task import has_fingers, task_of_model, task_of_room
from mart.protocol.tasks import arm_kinds_of, get_task

CUBES, WIPING = "two_arm_multi_cube_lifting", "three_arm_lift_wiping"


def test_arms_of_other_kinds_have_their_own_joints_bases_and_limits() -> None:
    pandas, mixed = get_task(CUBES), get_task(CUBES, kinds=("gen3", "ur5e"))
    shapes = {o.name: o.shape for o in mixed.observations}
    assert shapes["arm0/joint_positions"] == (7,)
    assert shapes["arm1/joint_positions"] == (6,)
    assert [o.name for o in mixed.observations] == [o.name for o in pandas.observations]
    nearer_m = mixed.arms[0].pose_base_in_world.position - pandas.arms[0].pose_base_in_world.position
    assert nearer_m == pytest.approx([0.06, 0.0, 0.0])
    assert np.array_equal(
        mixed.arms[1].pose_base_in_world.position, pandas.arms[1].pose_base_in_world.position
    )
    assert mixed.arm("arm0").kind.limits.step_rad == 0.2
    assert mixed.arm_kinds == ("gen3", "ur5e")


def test_pandas_are_not_named() -> None:
    assert get_task(CUBES).arm_kinds == get_task(CUBES, kinds=("panda", "panda")).arm_kinds == ()
    assert get_task(CUBES, kinds=("panda", "panda")).observations == get_task(CUBES).observations
    assert arm_kinds_of(CUBES, None, {}) == arm_kinds_of(CUBES, None, {"arm1": "panda"}) == ()
    assert arm_kinds_of(CUBES, 3, {"arm1": "ur5e"}) == ("panda", "ur5e", "panda")


def test_what_cannot_be_is_said() -> None:
    with pytest.raises(InvalidInput, match=r"3 kinds of arms were given; .* has 2 arms: name one for each"):
        get_task(CUBES, kinds=("ur5e",) * 3)
    with pytest.raises(NotFound, match=r"kind of arm 'ur6e'\. Did you mean 'ur5e'"):
        arm_kinds_of(CUBES, None, {"arm1": "ur6e"})
    with pytest.raises(NotFound, match="arm0, arm1"):
        arm_kinds_of(CUBES, None, {"arm2": "ur5e"})


def test_rooms_and_models_say_their_arms() -> None:
    seats = [Seat(arm="arm0"), Seat(arm="arm1")]
    kinds = ("panda", "ur5e")
    assert task_of_room(RoomStatus(task=CUBES, seats=seats, arm_kinds=kinds)).arm_kinds == kinds
    assert task_of_room(RoomStatus(task=CUBES, seats=seats)).arm_kinds == ()
    assert task_of_model(Model(task=CUBES, arms=["arm0", "arm1"], arm_kinds=kinds)).arm_kinds == kinds


def test_records_name_kinds_only_where_there_are_others_than_pandas() -> None:
    assert "arm_kinds" not in RoomRecord(room="room-1").to_strings()
    record = RoomRecord(room="room-1", arm_kinds=("panda", "ur5e"))
    assert record.to_strings()["arm_kinds"] == "panda,ur5e"
    assert RoomRecord.from_strings(record.to_strings()) == record
    assert EpisodeRecord.model_fields["arm_kinds"].default == ()


def test_a_task_says_before_its_room_opens_who_cannot_grip() -> None:
    words = (
        r"arm1, a Universal Robots UR5e with Wiping pad \(ur5e\+wiping_pad\), has no fingers, and Multi-cube"
    )
    with pytest.raises(InvalidInput, match=words):
        arm_kinds_of(CUBES, None, {"arm1": "ur5e+wiping_pad"})
    with pytest.raises(InvalidInput, match=r"arm0, .* needs it to grip \(arm2 may do without\)"):
        get_task(WIPING, kinds=("panda+wiping_pad", "panda", "panda"))


def test_an_arm_without_fingers_wipes_with_what_it_has() -> None:
    usual, task = get_task(WIPING), get_task(WIPING, kinds=("panda", "panda", "ur5e+wiping_pad"))
    assert {o.name for o in usual.observations} - {o.name for o in task.observations} == {
        "arm2/gripper",
        "sponge/position_in_world",
        "sponge/quaternion_in_world",
    }
    assert "sponge" not in f"{task.instruction} {task.subtasks}"
    assert get_task(WIPING, kinds=("panda", "panda", "ur5e+robotiq_2f85")).instruction == usual.instruction


def test_an_arm_with_neither_fingers_nor_a_face_cannot_wipe(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MART_ARMS_DIR", str(tmp_path))
    (tmp_path / "end_effectors").mkdir()
    pad = (Path(finding.__file__).parent / "end_effectors" / "wiping_pad.toml").read_text()
    (tmp_path / "end_effectors" / "stick.toml").write_text(pad.partition("[wiping]")[0])
    with pytest.raises(
        InvalidInput, match="has no fingers for the sponge of Lift and wipe, and no face that wipes"
    ):
        get_task(WIPING, kinds=("panda", "panda", "panda+stick"))


def test_a_room_tells_which_of_its_arms_can_grip() -> None:
    seats = [Seat(arm=f"arm{n}") for n in range(3)]
    room = RoomStatus(task=WIPING, seats=seats, arm_kinds=("panda", "unknown", "panda+wiping_pad"))
    assert [has_fingers(room, arm) for arm in ("arm0", "arm1", "arm2", "arm3")] == [True, True, False, True]
