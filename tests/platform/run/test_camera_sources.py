"""What cameras are captured from lies in files of their owner's, and on no command line."""

from __future__ import annotations

import stat
from pathlib import Path

import pytest

from mart.platform.run.camera_sources import forgetting_sources, keep_sources
from mart.platform.run.plan import PlatformOptions, processes, room
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import RoomsRequest
from mart.protocol.vocabulary import ServiceKind

URL = "rtsp://ana:geheim@camera/stream"


def test_an_address_is_kept_private_and_given_by_its_file(tmp_path: Path) -> None:
    sources = keep_sources(tmp_path, "room-1", {"arm0": URL, "arm0-wrist": "0", "table": ""})
    assert sources["table"] is None  # captured elsewhere
    path = sources["arm0"]
    assert path is not None
    assert path.read_text() == URL
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    plan = processes(PlatformOptions(data_dir=tmp_path, cameras=sources))
    commands = {process.id: process.command for process in plan}
    assert "geheim" not in str(commands)
    assert f"arm0=@{path}" in commands["room-1-arm0"]
    assert commands["room-1"][-6:] == ("--camera", "arm0", "--camera", "arm0.wrist", "--camera", "table")
    assert [one.id for one in plan if one.kind == ServiceKind.CAMERA] == ["room-1-arm0", "room-1-arm0-wrist"]


def test_a_file_of_ones_own_is_named_whole_and_must_be_there(tmp_path: Path) -> None:
    video = tmp_path / "table.mp4"
    with pytest.raises(InvalidInput, match=r"table\.mp4"):
        keep_sources(tmp_path, "room-1", {"table": str(video)})
    video.touch()
    kept = keep_sources(tmp_path, "room-1", {"table": str(video)})["table"]
    assert kept is not None
    assert kept.read_text() == str(video)
    assert keep_sources(tmp_path, "room-1", {"table": f"@{video}"}) == {"table": video}


def test_nothing_is_kept_once_the_platform_has_stopped(tmp_path: Path) -> None:
    path = keep_sources(tmp_path, "room-1", {"arm0": URL})["arm0"]
    assert path is not None
    with forgetting_sources(tmp_path):
        assert path.is_file()
    assert not path.exists()


def test_a_room_that_a_page_opens_has_no_cameras(tmp_path: Path) -> None:
    options = PlatformOptions(data_dir=tmp_path, cameras={"arm0": None})
    opened = room(options, RoomsRequest.Open(room="room-2", task="two_arm_multi_cube_lifting"))
    assert "--camera" not in opened.command
