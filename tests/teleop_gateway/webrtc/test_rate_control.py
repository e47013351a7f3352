"""The limit of what a peer is sent: below what its link carries, back when it carries more, and never jumping about."""

from __future__ import annotations

import math
import random
import tracemalloc

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.teleop_gateway.webrtc.rate_control import FLOOR_BPS, RateControl, ReceiverReport

STEP_S = 0.05
REPORT_EVERY = 5
PACKET_BITS = 9_600
LONGEST_QUEUE_S = 0.3
NEED_BPS = 800_000.0

links_bps = st.floats(250_000, 6_000_000)
round_trips_s = st.floats(0.002, 0.4)
few = settings(max_examples=25)  # each is a minute of a link


class Link:
    """A link with a queue before it, and a receiver that reports; with an estimate of its own where `estimates`."""

    def __init__(self, bps: float, round_trip_s: float, *, estimates: bool, loss: float = 0.0) -> None:
        self.bps, self._round_trip_s, self._estimates, self._loss = bps, round_trip_s, estimates, loss
        self.control = RateControl()
        self.queue_s = 0.0
        self.sent_bps: list[float] = []
        self.queues_s: list[float] = []
        self._estimate_bps = 300_000.0
        self._lost = self._expected = 0.0
        self._step = 0

    def run(self, seconds: float, need_bps: float = NEED_BPS) -> None:
        self.sent_bps, self.queues_s = [], []
        for _ in range(int(seconds / STEP_S)):
            pictures_bps = min(need_bps, self.control.limit_bps())
            self._send(2 * pictures_bps if self.control.copies else pictures_bps)

    def mean_bps(self) -> float:
        return sum(self.sent_bps) / len(self.sent_bps)

    def _send(self, bps: float) -> None:
        self._step += 1
        now_s = self._step * STEP_S
        self.control.on_sent(round(bps * STEP_S / 8), now_s)
        queue_s = max(0.0, self.queue_s + STEP_S * (bps / self.bps - 1))
        lost_bits = max(0.0, queue_s - LONGEST_QUEUE_S) * self.bps
        growing = queue_s > self.queue_s + 1e-4 or queue_s >= LONGEST_QUEUE_S
        self.queue_s = min(queue_s, LONGEST_QUEUE_S)
        self._expected += bps * STEP_S / PACKET_BITS
        self._lost += lost_bits / PACKET_BITS + self._loss * bps * STEP_S / PACKET_BITS
        self.sent_bps.append(bps)
        self.queues_s.append(self.queue_s)
        if self._step % REPORT_EVERY == 0:
            round_trip_s = self._round_trip_s + self.queue_s
            report = ReceiverReport(int(self._lost), int(self._expected), round_trip_s)
            self.control.on_report(report, now_s)
            if self._estimates:
                self._estimate(growing, min(bps, self.bps))
                self.control.on_estimate(self._estimate_bps, now_s)

    def _estimate(self, growing: bool, incoming_bps: float) -> None:
        """As browsers do: a little below what comes while it queues, else higher, to half more than what comes."""
        if growing and self.queue_s > 0.02:
            self._estimate_bps = 0.85 * incoming_bps
        else:
            most_bps = max(self._estimate_bps, 1.5 * incoming_bps + 10_000)
            self._estimate_bps = min(most_bps, self._estimate_bps * 1.08 ** (STEP_S * REPORT_EVERY))


@few
@given(bps=links_bps, round_trip_s=round_trips_s, estimates=st.booleans())
def test_less_is_sent_than_the_link_carries_and_not_much_less(
    bps: float, round_trip_s: float, estimates: bool
) -> None:
    link = Link(bps, round_trip_s, estimates=estimates)
    link.run(15)
    link.run(40)
    wanted_bps = min(bps, NEED_BPS)
    assert 0.6 * wanted_bps <= link.mean_bps() <= wanted_bps * (1.0 if estimates else 1.2)
    if estimates:  # else a good tenth is lost before anybody knows
        assert sum(queue_s > 0.25 for queue_s in link.queues_s) < 0.1 * len(link.queues_s)


@few
@given(bps=st.floats(250_000, 700_000), round_trip_s=round_trips_s, estimates=st.booleans())
def test_a_link_that_gets_wide_again_is_used_again(bps: float, round_trip_s: float, estimates: bool) -> None:
    link = Link(bps, round_trip_s, estimates=estimates)
    link.run(20)
    link.bps = 6_000_000
    link.run(40)
    link.run(5)
    assert link.mean_bps() > 0.95 * NEED_BPS


@few
@given(bps=links_bps, round_trip_s=round_trips_s, estimates=st.booleans())
def test_the_limit_does_not_jump_about(bps: float, round_trip_s: float, estimates: bool) -> None:
    """Ends of a limit become rare where each is followed by a new one."""
    link = Link(bps, round_trip_s, estimates=estimates)
    link.run(30)
    link.run(60)
    ends = sum(
        before < 0.9 * NEED_BPS <= after
        for before, after in zip(link.sent_bps, link.sent_bps[1:], strict=False)
    )
    steps = sum(
        abs(after - before) > 0.1 * before
        for before, after in zip(link.sent_bps, link.sent_bps[1:], strict=False)
    )
    assert ends <= (6 if estimates else 12)
    assert steps <= 40


reports = st.tuples(
    st.integers(0, 10_000), st.integers(0, 10_000), st.floats(0, 5) | st.just(math.nan), st.floats(0, 1e9)
)


@given(st.lists(st.tuples(st.floats(0, 3), reports), max_size=60))
def test_whatever_is_reported_the_picture_stays_legible(
    told: list[tuple[float, tuple[int, int, float, float]]],
) -> None:
    control, now_s, lost, expected = RateControl(), 0.0, 0, 0
    for pause_s, (more_lost, more_expected, round_trip_s, estimate_bps) in told:
        now_s += pause_s
        lost, expected = lost + more_lost, expected + more_expected
        control.on_sent(2_000, now_s)
        control.on_report(ReceiverReport(lost, expected, round_trip_s), now_s)
        control.on_estimate(estimate_bps, now_s)
        assert control.limit_bps() >= FLOOR_BPS


@pytest.mark.parametrize("estimates", [True, False])
def test_one_percent_of_loss_is_no_reason_to_send_less(estimates: bool) -> None:
    link = Link(20e6, 0.3, estimates=estimates, loss=0.01)
    link.run(30)
    assert link.control.limit_bps() == math.inf


@pytest.mark.parametrize("reports_meanwhile", [True, False])
def test_an_outage_is_no_full_link(reports_meanwhile: bool) -> None:
    """Everything was lost for three seconds, and what came then is told in one report."""
    control, lost = RateControl(), 0
    for step in range(80):
        now_s, dark = 0.25 * step, 20 <= step < 32
        control.on_sent(25_000, now_s)
        if dark and not reports_meanwhile:
            continue
        lost = 600 if step >= 32 else lost
        expected = 50 * min(step, 20) if dark else 50 * step
        control.on_report(ReceiverReport(lost, expected, 0.05), now_s)
        assert control.limit_bps() == math.inf


def test_an_estimate_that_falls_without_any_queue_is_not_believed() -> None:
    """Where delay varies by tens of milliseconds, a browser's falls below what it receives, and falls on."""
    control, estimate_bps, draws = RateControl(), 3e6, random.Random(0)
    for step in range(400):
        now_s = 0.25 * step
        control.on_sent(60_000, now_s)
        control.on_report(ReceiverReport(step // 2, 50 * step, 0.24 + draws.random() * 0.12), now_s)
        estimate_bps *= 0.99
        control.on_estimate(estimate_bps, now_s)
    assert control.limit_bps() == math.inf


def test_an_estimate_that_was_never_tried_limits_nothing() -> None:
    """A resting world sends little, and a receiver cannot know what it would get if more were sent."""
    control = RateControl()
    for step in range(100):
        control.on_sent(200, step * 0.5)
        control.on_estimate(300_000 + 100 * step, step * 0.5)
    assert control.limit_bps() == math.inf


@pytest.mark.parametrize(
    ("round_trip_s", "estimate_bps", "limited"),
    [(1.0, 450_000, True), (1.0, 750_000, False), (0.4, 450_000, False)],
)
def test_a_link_that_is_full_from_the_first_packet_on_is_found_by_both(
    round_trip_s: float, estimate_bps: int, limited: bool
) -> None:
    control = RateControl()
    for step in range(12):  # three seconds of 800 kbit/s
        control.on_sent(25_000, 0.25 * step)
        control.on_report(ReceiverReport(0, 20 * step, round_trip_s), 0.25 * step)
        control.on_estimate(estimate_bps, 0.25 * step)
    assert (control.limit_bps() < estimate_bps) is limited


def test_a_receiver_that_floods_or_to_which_nothing_is_sent_fills_no_memory() -> None:
    control = RateControl()
    tracemalloc.start()
    for step in range(3_000):
        control.on_report(ReceiverReport(0, 0, 0.01), 0.001 * step)
    grown_bytes, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert grown_bytes < 300_000


def _lossy(round_trip_s: float, loss: float, lossless_s: float = 0.0) -> RateControl:
    """Ten seconds with losses, and then some without."""
    control, lost = RateControl(), 0
    for step in range(int((10.0 + lossless_s) / 0.25)):
        lost = int(loss * 50 * min(step, 40))
        control.on_sent(25_000, 0.25 * step)
        control.on_report(ReceiverReport(lost, 50 * step, round_trip_s), 0.25 * step)
    return control


@pytest.mark.parametrize(
    ("round_trip_s", "loss", "copies"),
    [(0.3, 0.01, True), (0.3, 0.0, False), (0.03, 0.01, False), (0.3, 0.2, False)],
)
def test_copies_are_for_a_far_receiver_that_loses_a_little(
    round_trip_s: float, loss: float, copies: bool
) -> None:
    assert _lossy(round_trip_s, loss).copies is copies


@pytest.mark.parametrize(("lossless_s", "copies"), [(25.0, True), (32.0, False)])
def test_copies_end_half_a_minute_after_the_last_loss(lossless_s: float, copies: bool) -> None:
    assert _lossy(0.3, 0.01, lossless_s).copies is copies


def test_a_link_that_is_too_thin_for_copies_gets_coarser_pictures_instead_of_none() -> None:
    link = Link(1_500_000, 0.3, estimates=True, loss=0.01)
    link.run(30, need_bps=2_000_000)
    link.run(30, need_bps=2_000_000)
    assert link.control.copies
    assert link.mean_bps() < 1_500_000  # copies included
    thinner = Link(400_000, 0.3, estimates=True, loss=0.01)
    thinner.run(60, need_bps=2_000_000)
    assert not thinner.control.copies


def test_a_lost_report_changes_nothing() -> None:
    control = RateControl()
    control.on_report(ReceiverReport(0, 0), 0.0)
    control.on_report(ReceiverReport(0, 500), 100.0)
    assert control.limit_bps() == math.inf
