"""Compiled models are loaded as they were made, or refused."""

from __future__ import annotations

import hashlib

import mujoco
import pytest

from mart.protocol.errors import Corrupt, NotFound
from mart.render import load_model, viewpoint_id
from mart.sim.world import World


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


def load(mjb: bytes, sha256: str) -> mujoco.MjModel:
    return load_model(mjb, sha256=sha256, mujoco_version="4.0.0", source="a test")


def test_a_model_comes_back_as_it_was_sent(world: World) -> None:
    model = load(world.model_bytes(), world.model_sha256)
    assert (model.nq, model.ncam) == (world.model.nq, world.model.ncam)
    assert viewpoint_id(model, "arm1") == world.model.camera("arm1").id


def test_a_model_that_does_not_match_its_digest_is_refused(world: World) -> None:
    with pytest.raises(Corrupt, match="a test"):
        load(world.model_bytes(), "0" * 64)  # it could be loaded


def test_a_model_that_cannot_be_loaded_is_refused(world: World) -> None:
    cut = world.model_bytes()[:1000]
    with pytest.raises(Corrupt):
        load(cut, hashlib.sha256(cut).hexdigest())


def test_an_unknown_viewpoint_is_refused(world: World) -> None:
    with pytest.raises(NotFound):
        viewpoint_id(world.model, "arm9")
