"""The tick in the picture reads back, and nothing else does."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.render import Image
from mart.teleop_gateway.video import tick_code


def picture(tick: int) -> Image:
    rgb = np.zeros((tick_code.HEIGHT_PX, tick_code.WIDTH_PX, 3), np.uint8)
    tick_code.write(tick, rgb[tick_code.VIEW_HEIGHT_PX :])
    return rgb


@given(st.integers(0, 2**40))
def test_round_trip_of_the_low_32_bits(tick: int) -> None:
    assert tick_code.read(picture(tick)[:, :, 0]) == tick % 2**32


@given(st.integers(0, 2**32 - 1), st.integers(0, 39))
def test_one_wrong_square_is_noticed(tick: int, square: int) -> None:
    luma = picture(tick)[:, :, 0]
    squares = slice(square * tick_code.SQUARE_PX, (square + 1) * tick_code.SQUARE_PX)
    luma[tick_code.VIEW_HEIGHT_PX :, squares] = 255 - luma[tick_code.VIEW_HEIGHT_PX :, squares]
    assert tick_code.read(luma) is None


@pytest.mark.parametrize("value", [0, 255])
def test_an_empty_picture_has_no_tick(value: int) -> None:
    assert tick_code.read(np.full((tick_code.HEIGHT_PX, tick_code.WIDTH_PX), value, np.uint8)) is None


def test_the_strip_is_laid_out_as_specified() -> None:
    """Most significant bit first, 16 px squares, then the checksum: pages read it the same way."""
    strip = picture(0x80000001)[tick_code.VIEW_HEIGHT_PX :, :, 0]
    bits = (strip[8, 8::16] >= 128).astype(int).tolist()
    check = 0x80 ^ 0x00 ^ 0x00 ^ 0x01 ^ 0xA5
    assert bits == [1, *[0] * 30, 1, *(check >> (7 - i) & 1 for i in range(8))]
    assert strip.shape == (16, 640)
