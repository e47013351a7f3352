"""Captured pictures are shown whole, old ones say so, and bytes that are no picture are refused."""

from __future__ import annotations

from fractions import Fraction

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import State
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.video.captured_pictures import decode_picture, fit_into
from mart.teleop_gateway.video.picture_painter import CameraPainter, CapturedPicture, UnpaintedPicture
from mart.teleop_gateway.video.quality import FAST
from tests.teleop_gateway.cameras.fake_capture import plain


def jpeg_of(rows: int = 48, columns: int = 64) -> bytes:
    return cv2.imencode(".jpg", plain((30, 180, 60), rows, columns))[1].tobytes()


@given(rows=st.integers(1, 60), columns=st.integers(1, 60))
def test_a_picture_of_any_shape_is_seen_whole(rows: int, columns: int) -> None:
    out = np.full((48, 64, 3), 255, np.uint8)
    fit_into(plain((9, 9, 9), rows, columns), out)
    shown = (out == 9).all(axis=2)
    assert set(np.unique(out)) <= {0, 9}
    assert shown.any(axis=1).all() or shown.any(axis=0).all()  # it fills one direction
    assert shown[23:25, 31:33].any()


@given(st.binary(max_size=200))
def test_what_is_no_jpeg_is_refused(garbage: bytes) -> None:
    for given_bytes in (garbage, b"\xff\xd8" + garbage, jpeg_of()[:60] + garbage):
        try:
            decode_picture(given_bytes)
        except Corrupt:
            continue


def test_a_jpeg_that_would_fill_the_memory_is_refused_before_it_is_decoded() -> None:
    jpeg = bytearray(jpeg_of())
    at = jpeg.index(b"\xff\xc0")
    jpeg[at + 5 : at + 9] = b"\xff\xff\xff\xff"
    with pytest.raises(Corrupt):
        decode_picture(bytes(jpeg))


@pytest.mark.parametrize("share", [Fraction(1), Fraction(1, 2)])
def test_an_old_picture_is_dark_with_words_and_keeps_its_tick(share: Fraction) -> None:
    quality = FAST.sized(share)
    painter, fresh, old = CameraPainter(FAST), quality.blank_picture(), quality.blank_picture()
    painter.resize(quality)
    painter.paint(UnpaintedPicture(CapturedPicture(jpeg_of()), 77, 0, 0), fresh)
    painter.paint(UnpaintedPicture(CapturedPicture(jpeg_of(), "arm0: no picture for 3 s"), 77, 0, 0), old)
    middle = quality.view_height_px // 2
    assert fresh[5, 5].tolist() == pytest.approx([60, 180, 30], abs=4)
    assert old[5, 5].max() < 60
    assert old[middle - 10 : middle + 10].max() > 200  # letters
    for picture in (fresh, old):
        assert tick_code.read(np.ascontiguousarray(picture[..., 0])) == 77


def test_a_camera_that_never_gave_a_picture_shows_words_alone() -> None:
    picture = FAST.blank_picture()
    CameraPainter(FAST).paint(UnpaintedPicture(CapturedPicture(b"", "table: no picture"), 0, 0, 0), picture)
    assert picture[:200].max() == 0
    assert picture[200:280].max() > 200


def test_a_view_paints_what_it_is_for() -> None:
    with pytest.raises(InvalidInput):
        CameraPainter(FAST).paint(UnpaintedPicture.of(State(), 0), FAST.blank_picture())
