"""A task takes any mix of arms, and says it as files and messages do."""

from __future__ import annotations

import numpy as np
import pytest

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import Model, RoomStatus, Seat
from mart.protocol.recording import EpisodeRecord, RoomRecord
from mart.protocol.room_task import task_of_model, task_of_room
from mart.protocol.tasks import arm_kinds_of, get_task

CUBES = "two_arm_multi_cube_lifting"


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
