"""The moving picture of the README is small, moves for as long as an episode, and is taken evenly."""

from __future__ import annotations

from PIL import Image, ImageSequence

from tools import session_picture


def test_the_picture_is_small_and_moves() -> None:
    assert session_picture.PICTURE.stat().st_size < session_picture.MAX_BYTES
    with Image.open(session_picture.PICTURE) as picture:
        assert picture.size == session_picture.SIZE_PX
        shown_ms = [frame.copy().info["duration"] for frame in ImageSequence.Iterator(picture)]
    assert len(shown_ms) > 20  # frames that show the same are one
    assert 6_000 < sum(shown_ms) < 20_000


def test_what_was_shown_at_each_beat_is_taken() -> None:
    red, green, blue = (Image.new("RGB", (1, 1), colour) for colour in ("red", "green", "blue"))
    shots = [(10.0, red), (10.1, green), (10.9, blue)]
    assert list(session_picture.evenly(shots, 4.0)) == [red, green, green, green, blue]
