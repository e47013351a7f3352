"""A camera is dark while it is closed, silent, frozen or black, and never for longer than that lasts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.teleop_gateway.cameras.picture_health import (
    BLACK_AFTER_S,
    FROZEN_AFTER_S,
    SILENT_AFTER_S,
    PictureHealth,
    wait_before_opening_s,
)
from tests.teleop_gateway.cameras.fake_capture import plain

GREEN = plain((30, 180, 60))


def opened(frozen_after_s: float = FROZEN_AFTER_S) -> PictureHealth:
    health = PictureHealth(0.0, frozen_after_s)
    health.opened(0.0)
    return health


def why(health: PictureHealth, now_s: float) -> str:
    darkness = health.darkness(now_s)
    return darkness.why if darkness else ""


def test_before_it_is_open_it_is_dark() -> None:
    assert "being opened" in why(PictureHealth(0.0), 0.0)


def test_a_failure_counts_from_when_it_began_and_ends_with_the_next_opening() -> None:
    health = opened()
    health.failed("Its pictures ended", 3.0)
    health.failed("It cannot be opened", 5.0)
    darkness = health.darkness(6.0)
    assert darkness is not None
    assert darkness.since_s == 3.0
    assert darkness.why == "It cannot be opened; it is tried again."
    health.opened(7.0)
    assert health.darkness(7.0) is None


def test_a_read_that_does_not_return_is_told() -> None:
    health = opened()
    health.see(GREEN, 1.0)
    assert not why(health, 1.0 + SILENT_AFTER_S)
    assert "No picture comes" in why(health, 1.1 + SILENT_AFTER_S)


def test_the_very_same_picture_is_frozen_and_one_with_noise_is_not() -> None:
    still, noisy = opened(), opened()
    for now_s in (0.1 * step for step in range(1, 70)):
        is_new = still.see(GREEN, now_s)
        assert is_new == (now_s - 0.1 <= FROZEN_AFTER_S)
        assert noisy.see(plain((30, 180, 60), noise=round(10 * now_s)), now_s)
    assert "frozen" in why(still, 6.9)
    assert not why(noisy, 6.9)


def test_where_it_is_asked_for_nothing_is_frozen() -> None:
    health = opened(math.inf)
    assert all(health.see(GREEN, float(now_s)) for now_s in range(100))


def test_black_is_dark_after_a_moment_and_a_dark_room_is_not() -> None:
    health = opened()
    for step in range(1, 40):
        health.see(plain((2, 2, 2), noise=step), 0.1 * step)
    assert "black" in why(health, 0.1 * step)
    assert 0.1 * step > BLACK_AFTER_S
    dim = np.zeros((90, 160, 3), np.uint8)
    dim[:, 80:] = 20
    health.see(dim, 4.0)
    assert not why(health, 4.0)


@given(failures=st.integers(0, 10_000))
def test_it_is_tried_again_soon_and_never_seldom(failures: int) -> None:
    assert (wait_before_opening_s(failures) == 0.0) == (failures == 0)
    assert wait_before_opening_s(failures) <= wait_before_opening_s(failures + 1) <= 8.0


@pytest.mark.parametrize("shape", [(1, 1), (3, 5), (4, 4)])
def test_a_picture_of_any_size_can_be_judged(shape: tuple[int, int]) -> None:
    assert opened().see(plain((90, 90, 90), *shape), 0.1)
