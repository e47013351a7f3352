"""Worlds of Pandas compile to the bytes that version 0.2 compiled, so that what it recorded can be stepped again."""

from __future__ import annotations

import pytest

from mart.protocol.tasks import arm_counts, task_names
from mart.sim.world import World

# SHA-256 at 20 Hz, by task and number of arms.
OF_0_2 = {
    ("practice_course", 1): "42ebe98b486e076e8418743c0d174b058eecc0f89f0f51cc30bb7c58b1a38a36",
    ("practice_course", 2): "f7de9abbeeb405eb3a6ac623ff6ac9213f80b03e699c38ec994fde63186b0101",
    ("two_arm_drink_tray_lifting", 2): "52182113d9fa48b1977a7955d7819596fdbfe1c49e45428bda0c02f40d7c3f74",
    ("two_arm_multi_cube_lifting", 2): "2f684c00eb5133b112d822eefdf138609756b9958cebfbaf6a4505991c6d985c",
    ("two_arm_multi_cube_lifting", 3): "5c2ebd4583011a021d85137d68e149f4556090a25571dddeb75c96dcf702416e",
    ("two_arm_multi_cube_lifting", 4): "7c5bc689be1ba205cd3de7e3f22ee8313e335143802cd9b8e4f6e9e3365ee828",
    ("two_arm_pick_place_handover", 2): "46019f06ee7e05ec2e152383f462127ac661a33bb45efc4757655f5c56d3b76f",
    ("two_arm_table_assembly", 2): "501a7b5e285514be14b934d5e1bb3836df2abab995c3171768c3ef1b4fa6eef5",
    ("three_arm_lift_wiping", 3): "349e4e9a7c6fccbb11f7854dfe675b263c7bb5c9b1b1ee308f0d9f1d825bb89c",
}

# The same with arms of other kinds, as the version before end effectors were files compiled them.
OF_OTHER_ARMS = {
    (
        "two_arm_multi_cube_lifting",
        "panda",
        "ur5e",
    ): "2fcdbe2cde5cf7365375ee618e1ff5ae777fec57eacd16ee22a6eae034ab8a2e",
    (
        "three_arm_lift_wiping",
        "ur5e",
        "gen3",
        "panda",
    ): "1d42673027b37afd2289f84367e4dbdb5308626d4ee219e7e9505d1ec8a8aa9a",
}


@pytest.mark.parametrize(("task", "arms"), OF_0_2, ids=str)
def test_pandas_compile_to_the_same_bytes_as_ever(task: str, arms: int) -> None:
    assert World.build(task, 20.0, arms).model_sha256 == OF_0_2[task, arms]


@pytest.mark.parametrize("room", OF_OTHER_ARMS, ids=" ".join)
def test_other_arms_compile_to_the_same_bytes_as_before_end_effectors(room: tuple[str, ...]) -> None:
    task, *kinds = room
    assert World.build(task, 20.0, kinds=kinds).model_sha256 == OF_OTHER_ARMS[room]


def test_every_task_is_held() -> None:
    assert OF_0_2.keys() == {(task, arms) for task in task_names() for arms in arm_counts(task)}
