"""Compiled models are loaded as they were made, or refused."""

from __future__ import annotations

import contextlib
import hashlib
import signal
from collections.abc import Iterable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import Corrupt, NotFound
from mart.render import load_model, model_probe, probe_script, viewpoint_id
from mart.sim.world import World
from tests.support.fuzzing import fuzzing


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


BOX = """
<mujoco><worldbody><light/><camera name="front" pos="0 0 3"/>
<body><freejoint/><geom type="box" size=".1 .1 .1"/></body></worldbody></mujoco>
"""


def compiled(changes: Iterable[tuple[int, int]] = ()) -> bytes:
    """A tiny compiled model with some bytes changed."""
    model = mujoco.MjModel.from_xml_string(BOX)
    buffer = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    for place, value in changes:
        buffer[place] = value
    return buffer.tobytes()


# Found by chance: MuJoCo 4.0.0 hangs in its loader over this one.
HANGS = ((70, 166), (2507, 205), (1152, 9))


def test_a_model_over_which_the_loader_hangs_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(model_probe, "_PROCESSOR_S", 1)
    mjb = compiled(HANGS)
    with pytest.raises(Corrupt):
        load(mjb, hashlib.sha256(mjb).hexdigest())


@fuzzing(examples=12)  # each is tried in a process of its own
@given(changes=st.lists(st.tuples(st.integers(0, 3000), st.integers(0, 255)), min_size=1, max_size=3))
def test_a_spoilt_model_is_refused_or_loaded_and_never_takes_this_process_along(
    changes: list[tuple[int, int]],
) -> None:
    mjb = compiled(changes)
    with contextlib.suppress(Corrupt):
        load(mjb, hashlib.sha256(mjb).hexdigest())


@pytest.mark.parametrize("number", [signal.SIGSEGV, signal.SIGXCPU])
def test_a_crash_over_a_model_is_a_sentence_and_is_tried_once(
    number: signal.Signals, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tries = tmp_path / "tries"
    script = tmp_path / "crash.py"
    script.write_text(
        f"import os; open({str(tries)!r}, 'a').write('x'); os.kill(os.getpid(), {number.value})"
    )
    monkeypatch.setattr(probe_script, "__file__", str(script))
    mjb = compiled([(0, number.value)])
    for _ in range(2):
        with pytest.raises(Corrupt, match=r"a test.*(crashes|is at it)"):
            load(mjb, hashlib.sha256(mjb).hexdigest())
    assert tries.read_text() == "x"


def test_an_unknown_viewpoint_is_refused(world: World) -> None:
    with pytest.raises(NotFound):
        viewpoint_id(world.model, "arm9")
