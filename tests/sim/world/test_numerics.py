"""What a process computes with is named, and a digest tells processes apart that compute otherwise."""

from __future__ import annotations

import math

import mujoco
import pytest

from mart.sim.world import numerics
from mart.sim.world.model_message import model_message
from mart.sim.world.numerics import own_numerics
from mart.sim.world.world import World


def test_processor_library_build_and_fingerprint_are_named() -> None:
    said = own_numerics()
    assert said.processor
    assert said.libm
    assert said.mujoco_build.startswith(mujoco.__version__)
    assert len(said.fingerprint) == 16
    int(said.fingerprint, 16)


def test_a_room_tells_it_with_its_model() -> None:
    assert model_message(World.build("two_arm_multi_cube_lifting")).numerics == own_numerics()


def test_the_last_bit_of_one_function_is_enough_for_another_fingerprint(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = numerics._fingerprint()
    assert numerics._fingerprint() == before

    def rounded_otherwise(value: float) -> float:
        return math.nextafter(math.sin(value), 2.0) if 1.0 < value < 1.1 else math.sin(value)

    functions = ((rounded_otherwise, *numerics._ONE_ARGUMENT[0][1:]), *numerics._ONE_ARGUMENT[1:])
    monkeypatch.setattr(numerics, "_ONE_ARGUMENT", functions)
    assert numerics._fingerprint() != before
