"""What a camera is captured from is checked before it is opened, and never repeated where it may hold a password."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput
from mart.teleop_gateway.cameras.camera_settings import CameraSettings
from mart.teleop_gateway.cameras.camera_source import CameraKind, load_source

SECRET = "geheim-77"
URL = f"rtsp://ana:{SECRET}@10.0.0.7:554/stream?token={SECRET}"


@pytest.mark.parametrize(
    ("text", "kind", "title"),
    [
        ("0", CameraKind.DEVICE, "/dev/video0"),
        ("/dev/video2", CameraKind.DEVICE, "/dev/video2"),
        (URL, CameraKind.STREAM, "rtsp://10.0.0.7/…"),
        (" http://camera.local/mjpeg \n", CameraKind.STREAM, "http://camera.local/…"),
    ],
)
def test_devices_and_streams(text: str, kind: CameraKind, title: str) -> None:
    source = load_source(text)
    assert (source.kind, source.title) == (kind, title)


def test_a_file_is_there_or_refused(tmp_path: Path) -> None:
    video = tmp_path / "table.mp4"
    with pytest.raises(InvalidInput, match=r"table\.mp4"):
        load_source(str(video))
    video.touch()
    assert load_source(str(video)).kind is CameraKind.FILE


def test_a_file_that_holds_the_address_is_private(tmp_path: Path) -> None:
    path = tmp_path / "wrist"
    path.write_text(URL + "\n")
    path.chmod(0o644)
    with pytest.raises(InvalidInput, match="chmod 600"):
        load_source(f"@{path}")
    path.chmod(0o600)
    assert load_source(f"@{path}").address == URL
    with pytest.raises(InvalidInput):
        load_source(f"@{tmp_path / 'missing'}")


@pytest.mark.parametrize(
    "text", ["", " ", "@", "rtsp://", "file:///etc/passwd", "concat://a|b", "x" * 5000, "a\0b"]
)
def test_what_names_nothing_is_refused(text: str) -> None:
    with pytest.raises(InvalidInput):
        load_source(text)


@given(path=st.text(st.characters(codec="ascii", categories=("L", "N")), max_size=20))
def test_no_password_is_ever_repeated(path: str) -> None:
    source = load_source(f"rtsp://ana:{SECRET}@camera/{path}")
    assert SECRET not in repr(source) + source.title
    with pytest.raises(InvalidInput) as refused:
        load_source(f"gopher://ana:{SECRET}@camera/{path}")
    assert SECRET not in str(refused.value)
    assert SECRET not in repr(CameraSettings(camera="arm0", source=source.address))
