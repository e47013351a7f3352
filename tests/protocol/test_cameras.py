"""Cameras are named by people; keys and files carry their ids."""

from __future__ import annotations

import pytest

from mart.protocol import keys
from mart.protocol.cameras import camera_id, camera_in_words, camera_title, cameras_of_seat
from mart.protocol.errors import InvalidInput


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("arm0", "the camera of arm0"),
        ("arm1.wrist", "the camera wrist of arm1"),
        ("table", "the camera table"),
    ],
)
def test_a_name_comes_back_and_fits_a_key(name: str, words: str) -> None:
    camera = camera_id(name)
    assert camera_title(camera) == name
    assert camera_in_words(camera) == words
    assert keys.video("room-1", camera).key.endswith(f"/{camera}/video")


@pytest.mark.parametrize(
    "name", ["", "Arm0", "arm0-wrist", "table.left", "a.b.c", "rtsp://u:geheim@h/x", "x" * 25]
)
def test_what_is_no_name_is_refused_without_being_repeated(name: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        camera_id(name)
    assert "geheim" not in str(refused.value)


def test_a_seat_shows_its_own_cameras_first_and_then_everybodys() -> None:
    known = ("table", "arm1", "arm0-wrist", "arm0")
    assert cameras_of_seat(known, "arm0") == ("arm0", "arm0-wrist", "table")
    assert cameras_of_seat(known, "arm2") == ("table",)
