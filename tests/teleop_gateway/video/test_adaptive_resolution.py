"""Pictures that come late become smaller, and large again when there is time, without going to and fro."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.teleop_gateway.video.adaptive_resolution import SIZES, AdaptiveResolution, at_full_size

HZ = 20.0
FULL, SMALLER, SMALLEST = SIZES


class ClockMessage:
    """Pictures at 20 Hz, each of which takes `cost_s` at full size, in proportion to its pixels."""

    def __init__(self) -> None:
        self.now_s = 100.0
        self.resolution = AdaptiveResolution(HZ)
        self.sizes: list[Fraction] = []

    def run(self, seconds: float, cost_s: float) -> Fraction:
        for _ in range(round(seconds * HZ)):
            self.now_s += 1.0 / HZ
            took_s = cost_s * float(self.resolution.size) ** 2
            self.sizes.append(self.resolution.record(took_s, self.now_s))
        return self.resolution.size

    @property
    def changes(self) -> int:
        return sum(before != after for before, after in zip(self.sizes, self.sizes[1:], strict=False))


def test_quick_pictures_stay_large() -> None:
    assert ClockMessage().run(60.0, cost_s=0.02) == FULL


def test_slow_pictures_shrink_within_a_second() -> None:
    assert ClockMessage().run(1.0, cost_s=0.04) == SMALLER


def test_very_slow_pictures_shrink_to_the_smallest_and_no_further() -> None:
    clock = ClockMessage()
    assert clock.run(2.0, cost_s=0.2) == SMALLEST
    assert clock.run(60.0, cost_s=0.2) == SMALLEST


def test_a_slow_picture_or_two_change_nothing() -> None:
    clock = ClockMessage()
    clock.run(10.0, cost_s=0.01)
    clock.run(0.1, cost_s=0.5)
    assert clock.run(10.0, cost_s=0.01) == FULL
    assert clock.changes == 0


def test_they_grow_again_when_there_is_time() -> None:
    clock = ClockMessage()
    clock.run(3.0, cost_s=0.2)
    assert clock.run(30.0, cost_s=0.01) == FULL


@given(cost_s=st.floats(0.001, 0.5))
def test_they_do_not_go_to_and_fro(cost_s: float) -> None:
    clock = ClockMessage()
    clock.run(60.0, cost_s)
    assert clock.changes <= len(SIZES) - 1


def test_a_machine_that_is_only_quick_while_pictures_are_small_is_tried_ever_less_often() -> None:
    clock = ClockMessage()
    for _ in range(3600):
        clock.run(1.0, cost_s=0.2 if clock.resolution.size == FULL else 0.005)
    assert clock.changes < 40


@given(took_s=st.lists(st.floats(0.0, 10.0), max_size=200))
def test_it_is_always_one_of_the_sizes(took_s: list[float]) -> None:
    resolution = AdaptiveResolution(HZ)
    now_s = 0.0
    for one_s in took_s:
        now_s += max(one_s, 1.0 / HZ)
        assert resolution.record(one_s, now_s) in SIZES


@pytest.mark.parametrize(("size", "took_s"), [(FULL, 0.0142), (SMALLER, 0.0109), (SMALLEST, 0.0070)])
def test_what_a_full_picture_would_take_is_told_from_a_smaller_one(size: Fraction, took_s: float) -> None:
    """The medians that were measured of one scene, drawn in software."""
    assert at_full_size(took_s, size) == pytest.approx(0.0142, rel=0.12)
