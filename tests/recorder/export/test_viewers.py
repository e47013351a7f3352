"""Files for viewers: read whole by stock tools, every body where MuJoCo has it, nothing overwritten."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from mart.episodes.reader import open_episode
from mart.episodes.scan import ForeignFile
from mart.protocol.errors import Conflict, Corrupt, InvalidInput, Unavailable
from mart.protocol.messages import OUTCOME_FAILURE
from mart.recorder.export.foxglove_layout import layout
from mart.recorder.export.rerun import write_rerun
from mart.recorder.export_cli import export
from mart.sim.world import World
from tests.recorder.files import write_episode
from tests.recorder.importing import sources
from tests.trainer import recorded


class Shown:
    """An episode that failed, and its file for Foxglove."""

    def __init__(self, root: Path) -> None:
        self.world = World.build(recorded.TASK)
        states = recorded.perform(self.world, 1)[:12]
        self.root = root
        self.path = recorded.write(
            root / "episodes", self.world, states, outcome=OUTCOME_FAILURE, with_model=True
        )
        self.states = states
        self.foxglove = root / "seen.mcap"
        write(self.path, "foxglove", self.foxglove, "--layout", str(root / "layout.json"))
        self.messages = decoded(self.foxglove)


def write(episodes: Path, file_format: str, out: Path, *arguments: str) -> None:
    export.main(
        [str(episodes), "--format", file_format, "--out", str(out), *arguments], standalone_mode=False
    )


def decoded(path: Path) -> dict[str, list[Any]]:
    found = defaultdict(list)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for _, channel, _, message in reader.iter_decoded_messages():
            found[channel.topic].append(message)
    return found


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Shown:
    return Shown(tmp_path_factory.mktemp("shown"))


def test_the_recorded_messages_are_as_they_were(shown: Shown) -> None:
    recorded_messages = list(open_episode(shown.path).messages())
    with shown.foxglove.open("rb") as file:
        copied = [
            (channel.topic, message.data, message.log_time, message.publish_time, message.sequence)
            for _, channel, message in make_reader(file).iter_messages(log_time_order=False)
        ]
    for one in recorded_messages:
        assert (one.topic, one.payload, one.arrived_ns, one.sent_ns, one.sequence) in copied


def test_every_body_is_where_mujoco_has_it(shown: Shown) -> None:
    model = shown.world.model
    bodies = {f"body/{model.body(i).name}": i for i in range(model.nbody)}
    ticks = [m for m in shown.messages["/tf"] if any(t.child_frame_id in bodies for t in m.transforms)]
    assert len(ticks) == len(shown.states)
    for state, message in zip(shown.states, ticks, strict=True):
        data = mujoco.MjData(model)
        integration = np.frombuffer(state.integration_state, "<f8")
        mujoco.mj_setState(model, data, integration, mujoco.mjtState.mjSTATE_INTEGRATION)
        mujoco.mj_kinematics(model, data)
        assert {one.child_frame_id for one in message.transforms} >= {"body/cube0", "body/arm1/hand"}
        for one in message.transforms:
            body = bodies[one.child_frame_id]
            place, turn = one.translation, one.rotation
            np.testing.assert_array_equal([place.x, place.y, place.z], data.xpos[body])
            np.testing.assert_array_equal([turn.w, turn.x, turn.y, turn.z], data.xquat[body])


def test_the_scene_hangs_on_frames_that_are_there(shown: Shown) -> None:
    (scene,) = shown.messages["/scene"]
    frames = {one.child_frame_id for message in shown.messages["/tf"] for one in message.transforms}
    assert {entity.frame_id for entity in scene.entities} <= frames | {"world"}
    hand = next(entity for entity in scene.entities if entity.id == "arm0/hand")
    for mesh in hand.triangles:
        assert max(mesh.indices) < len(mesh.points)
        assert len(mesh.indices) % 3 == 0


def test_cameras_look_where_mujoco_has_them(shown: Shown) -> None:
    """A cube's place in the picture, once by the calibration and once by MuJoCo's camera."""
    model, data = shown.world.model, mujoco.MjData(shown.world.model)
    mujoco.mj_forward(model, data)
    (calibration,) = shown.messages["/view/front/calibration"]
    frame = next(t for m in shown.messages["/tf"] for t in m.transforms if t.child_frame_id == "front")
    camera = model.camera("front").id
    point = np.array([0.1, -0.2, 0.05])
    seen = data.cam_xmat[camera].reshape(3, 3).T @ (point - data.cam_xpos[camera])
    scale = 240 / np.tan(np.deg2rad(model.cam_fovy[camera]) / 2) / -seen[2]
    rotation = np.empty(9)
    turn = frame.rotation
    mujoco.mju_quat2Mat(rotation, np.array([turn.w, turn.x, turn.y, turn.z]))
    position = np.array([frame.translation.x, frame.translation.y, frame.translation.z])
    pixel = np.array(calibration.K).reshape(3, 3) @ rotation.reshape(3, 3).T @ (point - position)
    np.testing.assert_allclose(
        pixel[:2] / pixel[2], [320 + scale * seen[0], 240 - scale * seen[1]], rtol=1e-9
    )


def test_it_is_no_episode_again(shown: Shown) -> None:
    with pytest.raises(ForeignFile):
        open_episode(shown.foxglove)


def test_the_layout_shows_all_of_it(shown: Shown) -> None:
    said = json.loads((shown.root / "layout.json").read_text())
    assert {"3D!world", "Plot!arm0", "Plot!arm1"} <= said["configById"].keys()
    with_pictures = layout(("arm0",), ["arm0", "front"])
    assert panels(with_pictures["layout"]) == with_pictures["configById"].keys()


def panels(node: Any) -> set[str]:
    return {node} if isinstance(node, str) else panels(node["first"]) | panels(node["second"])


def test_nothing_is_overwritten_and_nothing_left_half(shown: Shown, tmp_path: Path) -> None:
    with pytest.raises(Conflict):
        write(shown.path, "foxglove", shown.foxglove)
    with pytest.raises(InvalidInput):
        write(tmp_path, "foxglove", tmp_path / "a.mcap")
    with pytest.raises(InvalidInput):
        write(shown.path, "robomimic", tmp_path / "a.hdf5", "--layout", str(tmp_path / "b"))
    assert not list(tmp_path.iterdir())


def test_several_go_into_a_folder(shown: Shown, tmp_path: Path) -> None:
    other = recorded.write(tmp_path / "episodes", shown.world, shown.states)
    write(tmp_path / "episodes", "foxglove", tmp_path / "seen")
    assert [one.name for one in (tmp_path / "seen").iterdir()] == [other.name]
    assert "/scene" not in decoded(tmp_path / "seen" / other.name)  # it carries no model


def test_what_was_imported_to_be_looked_at_is_shown(tmp_path: Path) -> None:
    sources.write_demo(tmp_path / "a.hdf5", {"actions": np.ones((4, 3)), "obs/x": np.ones(4)})
    one = sources.only(sources.imported(tmp_path / "a.hdf5", tmp_path / "in"))
    write(one.path, "foxglove", tmp_path / "seen.mcap", "--layout", str(tmp_path / "layout.json"))
    assert len(decoded(tmp_path / "seen.mcap")["/state"]) == 4


def test_a_model_that_cannot_be_loaded_is_told_of(tmp_path: Path) -> None:
    path = write_episode(tmp_path / "episodes").path  # of the toy room, whose model is none
    with pytest.raises(Corrupt, match="model"):
        write(path, "foxglove", tmp_path / "seen.mcap")
    assert not list(tmp_path.glob("seen*"))


def test_without_rerun_a_sentence_says_what_to_install(
    shown: Shown, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(Unavailable, match="pip install"):
        write_rerun(open_episode(shown.path), tmp_path / "a.rrd")


if importlib.util.find_spec("rerun") is not None:  # an extra that is asked for, half a gigabyte

    def test_rerun_reads_what_was_written_for_it(shown: Shown, tmp_path: Path) -> None:
        write(shown.path, "rerun", tmp_path / "a.rrd")
        tool = [str(Path(sys.executable).with_name("rerun")), "rrd"]
        environment = {"HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}
        subprocess.run([*tool, "verify", tmp_path / "a.rrd"], check=True, env=environment, timeout=60)
        said = subprocess.run(
            [*tool, "print", "-vv", tmp_path / "a.rrd"],
            check=True, env=environment, timeout=60, capture_output=True, text=True,
        ).stdout  # fmt: skip
        for entity in (
            "/world/arm0_hand",
            "/world/cube0",
            "/action/arm0",
            "/observation/cube0/position_in_world",
        ):
            assert entity in said
