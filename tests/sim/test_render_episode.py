"""`mart episodes render`: a file that the stock MCAP library wrote becomes a video."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO

import av
import mujoco
import numpy as np
import pytest
from click.testing import CliRunner
from mcap.writer import Writer

from mart.protocol import codec
from mart.protocol.errors import Corrupt, InvalidInput, MartError, NotFound
from mart.protocol.messages import State
from mart.protocol.recording import MODEL_ATTACHMENT, PROFILE, STATE, RoomRecord
from mart.runtime.child_process import start_child
from mart.runtime.cli import cli
from mart.sim import render_process
from mart.sim.render_episode import render_episode
from mart.sim.world import World

TICKS = 12


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


def recorded(path: Path, world: World, **room: object) -> Path:
    """Two arms go forward and up; every state comes twice, as a late one may."""
    facts = {
        "room": "room-1",
        "control_hz": 20.0,
        "model_sha256": world.model_sha256,
        "mujoco_version": mujoco.__version__,
        **room,
    }
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile=PROFILE)
        writer.add_metadata(RoomRecord.NAME, RoomRecord.model_validate(facts).to_strings())
        writer.add_attachment(0, 0, MODEL_ATTACHMENT, "application/octet-stream", world.model_bytes())
        channel = writer.register_channel(
            STATE, "protobuf", writer.register_schema("mart.v1.State", "protobuf", b"")
        )
        world.reset(0)
        for tick in range(TICKS):
            payload = codec.encode(State(tick=tick, integration_state=world.integration_state()))
            for _ in range(2):
                writer.add_message(channel, tick, payload, tick)
            world.step(np.tile((1.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0), (2, 1)))
        writer.finish()  # type: ignore[no-untyped-call]
    return path


def test_one_picture_for_each_state_in_real_time(world: World, tmp_path: Path) -> None:
    file, video = recorded(tmp_path / "one.mcap", world), tmp_path / "one.mp4"
    assert render_episode(file, video, "arm0", 160, 120) == TICKS
    with av.open(video) as container:
        (stream,) = container.streams.video
        assert stream.average_rate == 20
        pictures = [frame.to_ndarray(format="rgb24").astype(int) for frame in container.decode(stream)]
    assert [picture.shape for picture in pictures] == [(120, 160, 3)] * TICKS
    assert np.abs(pictures[-1] - pictures[0]).max() > 100  # it moves
    assert sorted(tmp_path.iterdir()) == [file, video]


def test_the_command_says_where_the_video_is(
    world: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    recorded(tmp_path / "one.mcap", world)
    arguments = ["episodes", "render", "one.mcap", "--width", "64", "--height", "48", "--json"]
    said = json.loads(CliRunner().invoke(cli, arguments, catch_exceptions=False).output)
    assert said == {"video": "one-front.mp4", "frames": TICKS}
    assert Path("one-front.mp4").stat().st_size > 1000


@pytest.mark.parametrize(
    ("room", "options", "error"),
    [
        ({}, {"viewpoint": "arm9"}, NotFound),
        ({}, {"width_px": 63}, InvalidInput),
        ({}, {"width_px": 100_000}, InvalidInput),
        ({"model_sha256": "0" * 64}, {}, Corrupt),
        ({"control_hz": None}, {}, Corrupt),
    ],
)
def test_what_cannot_be_drawn_is_refused(
    *,
    world: World,
    tmp_path: Path,
    room: dict[str, object],
    options: dict[str, object],
    error: type[MartError],
) -> None:
    chosen = {"viewpoint": "front", "width_px": 64, "height_px": 48, **options}
    file = recorded(tmp_path / "one.mcap", world, **room)
    with pytest.raises(error):
        render_episode(file, tmp_path / "one.mp4", **chosen)  # type: ignore[arg-type]
    assert not (tmp_path / "one.mp4").exists()


def test_a_process_that_is_lost_over_an_episode_is_one_sentence(
    world: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def crashing(_command: Sequence[str], log: IO[bytes], _env: Mapping[str, str], *, piped: bool) -> object:
        lost = [sys.executable, "-c", "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"]
        return start_child(lost, log, {}, piped=piped)

    monkeypatch.setattr(render_process, "start_child", crashing)
    file = recorded(tmp_path / "one.mcap", world)
    with pytest.raises(Corrupt, match=r"one\.mcap cannot be drawn.*SIGSEGV"):
        render_process.render_in_process(file, tmp_path / "one.mp4", "front", 64, 48)


def test_its_pictures_are_counted_here(world: World, tmp_path: Path) -> None:
    file, counted = recorded(tmp_path / "one.mcap", world), list[int]()
    frames = render_process.render_in_process(
        file, tmp_path / "one.mp4", "front", 64, 48, on_picture=lambda: counted.append(1)
    )
    assert frames == len(counted) == TICKS


def test_what_is_refused_in_the_process_is_refused_here(world: World, tmp_path: Path) -> None:
    file = recorded(tmp_path / "one.mcap", world)
    with pytest.raises(NotFound):
        render_process.render_in_process(file, tmp_path / "one.mp4", "arm9", 64, 48)
