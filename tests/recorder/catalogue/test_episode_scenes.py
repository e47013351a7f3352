"""A page draws an episode from its scene and motion, which are MuJoCo's own positions; spoilt files cost a sentence."""

from __future__ import annotations

import gzip
import hashlib
import io
import struct
import tarfile
from pathlib import Path
from typing import BinaryIO

import mujoco
import numpy as np
import pytest

from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import CatalogueReply, CatalogueRequest, State
from mart.recorder.catalogue import episode_scenes, motion
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.catalogue.motion import write_motion
from mart.render import BodyPoses, load_model
from mart.render.moving_bodies import moving_bodies
from tests.recorder.files import write_episode

ARCHIVE = Path("tests/fixtures/episodes_0_1_0/episodes.tar.xz")
PATH = "2026-11-29/lockstep.mcap"
HZ = 20.0
HEADER_BYTES, SECOND_BYTES, POSES_HEADER_BYTES = 8, 8, 24


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("episodes")
    with tarfile.open(ARCHIVE) as archive:
        archive.extract(next(one for one in archive if one.name.endswith(PATH)), root, filter="data")
    return root


@pytest.fixture(scope="module")
def file(root: Path) -> EpisodeFile:
    return EpisodeFile.open(root / PATH)


@pytest.fixture(scope="module")
def model(file: EpisodeFile) -> mujoco.MjModel:
    room = file.room
    assert room.model_sha256
    return load_model(file.model(), sha256=room.model_sha256, mujoco_version="its", source="the file")


def scene_of(asked: CatalogueHandlers, path: str = PATH, known: tuple[str, ...] = ()) -> CatalogueReply.Piece:
    return asked.answer(CatalogueRequest(scene=CatalogueRequest.Scene(path=path, known_sha256=known))).piece


def whole_motion(asked: CatalogueHandlers) -> bytes:
    got = b""
    while True:
        request = CatalogueRequest.Motion(path=PATH, offset=len(got), simulated=True)
        piece = asked.answer(CatalogueRequest(motion=request)).piece
        got += piece.piece
        if len(got) >= piece.size_bytes:
            return got


def test_the_scene_is_named_by_its_digest_and_not_sent_twice(root: Path) -> None:
    asked = CatalogueHandlers(root)
    sent = scene_of(asked)
    assert hashlib.sha256(gzip.decompress(sent.piece)).hexdigest() == sent.sha256
    again = scene_of(asked, known=(sent.sha256,))
    assert (again.sha256, again.piece) == (sent.sha256, b"")


def test_the_bodies_are_where_mujoco_has_them(
    root: Path, file: EpisodeFile, model: mujoco.MjModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(episode_scenes, "PIECE_BYTES", 1000)
    asked = CatalogueHandlers(root)
    got, states = whole_motion(asked), list(file.states())
    magic, row_bytes = struct.unpack_from("<4sI", got)
    assert (magic, (len(got) - HEADER_BYTES) // row_bytes) == (b"MMO1", len(states))
    data, bodies = mujoco.MjData(model), list(moving_bodies(model))
    is_shadow = np.array([model.body_mocapid[body] >= 0 for body in bodies])  # they lie where they are drawn
    for row in (0, 20, len(states) - 1):
        begin = HEADER_BYTES + row * row_bytes
        assert struct.unpack_from("<d", got, begin) == ((states[row].tick - states[0].tick) / HZ,)
        magic, _, tick, step_m, count, _ = struct.unpack_from("<4s4sQfHH", got, begin + SECOND_BYTES)
        assert (magic, tick, count) == (b"MBP1", states[row].tick, len(bodies))
        at = begin + SECOND_BYTES + POSES_HEADER_BYTES
        numbers = np.frombuffer(got, "<i2", 7 * count, at).reshape(count, 7)
        state = np.frombuffer(states[row].integration_state, "<f8")
        mujoco.mj_setState(model, data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
        mujoco.mj_kinematics(model, data)
        moved = ~is_shadow
        np.testing.assert_allclose(numbers[moved, :3] * step_m, data.xpos[bodies][moved], atol=step_m)
        np.testing.assert_allclose(numbers[moved, 3:] / 32767, data.xquat[bodies][moved], atol=1e-4)


def test_a_spoilt_model_costs_a_sentence(root: Path, tmp_path: Path) -> None:
    path = write_episode(tmp_path, ticks=5, number=1).path.relative_to(tmp_path).as_posix()
    asked = CatalogueHandlers(tmp_path)
    with pytest.raises(Corrupt, match="It is not used"):
        scene_of(asked, path)
    with pytest.raises(Corrupt, match="It is not used"):
        asked.answer(CatalogueRequest(motion=CatalogueRequest.Motion(path=path)))


def test_states_of_another_model_are_refused(model: mujoco.MjModel) -> None:
    with pytest.raises(Corrupt, match="not of its model"):
        write_motion([State(integration_state=b"short")], BodyPoses(model, 64 * "0"), HZ, io.BytesIO())


def test_a_world_that_flew_apart_has_no_row(file: EpisodeFile, model: mujoco.MjModel) -> None:
    states = list(file.states())[:3]
    states[1].integration_state = np.full(len(states[1].integration_state) // 8, np.nan).tobytes()
    out = io.BytesIO()
    write_motion([*states, states[2]], BodyPoses(model, 64 * "0"), HZ, out)
    _, row_bytes = struct.unpack_from("<4sI", out.getvalue())
    assert len(out.getvalue()) == HEADER_BYTES + 2 * row_bytes


def test_of_a_long_episode_every_so_many_ticks_are_told_and_the_last(
    file: EpisodeFile, model: mujoco.MjModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    states = list(file.states())
    monkeypatch.setattr(motion, "MAX_MOTION_BYTES", 8000)
    out = io.BytesIO()
    write_motion(states, BodyPoses(model, 64 * "0"), HZ, out, len(states))
    got = out.getvalue()
    _, row_bytes = struct.unpack_from("<4sI", got)
    seconds = [struct.unpack_from("<d", got, at)[0] for at in range(HEADER_BYTES, len(got), row_bytes)]
    assert len(got) <= 8000
    assert (seconds[0], seconds[-1]) == (0.0, (states[-1].tick - states[0].tick) / HZ)
    assert len(seconds) > 8000 // row_bytes // 2
    assert len(set(np.diff(seconds[:-1]).round(6))) == 1


def test_scenes_of_many_models_are_kept_apart(root: Path, file: EpisodeFile) -> None:
    scenes = episode_scenes.EpisodeScenes(root)
    asked = CatalogueRequest.Scene(path=PATH)
    sent = scenes.scene(file, asked)

    def fill(out: BinaryIO) -> None:
        out.write(b"x")

    for number in range(80):  # more than are kept as files
        scenes._kept.piece(("scene", str(number)), fill, 0, 1)
    assert scenes.scene(file, asked) == sent


def test_an_episode_that_is_longer_than_it_says_is_refused(
    file: EpisodeFile, model: mujoco.MjModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(motion, "MAX_MOTION_BYTES", 2000)
    with pytest.raises(InvalidInput, match="too long"):
        write_motion(file.states(), BodyPoses(model, 64 * "0"), HZ, io.BytesIO())
