"""Decide what a receiver's link carries, by what the receiver reports. Pure: reports and `now_s` in, a limit out.

Two voices count. The receiver's own estimate (REMB, draft-alvestrand-rmcat-remb-03) is that of a browser's congestion
control: it falls where packets begin to queue, before any is lost. Reports of loss and round trips (RFC 3550) speak for
receivers without it, by the rules of draft-ietf-rmcat-gcc-02: loss of a tenth lowers the limit, none raises it by 8 % a
second.

There is no limit until something says that one is needed: a receiver to which little is sent can estimate little.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

FLOOR_BPS = 150_000  # ten pictures of 640 x 496 a second, in which a cube's spots can still be counted
_PICTURES_SHARE = 0.9  # of an estimate: the rest is for what else the link carries
_USUAL_BPS = 1_000_000  # what a moving scene takes at most, until it is known
_ROOMY = 1.3  # times what a scene took: then no limit is needed any more
_RAISE = 1.08  # a second
_LOWER = 0.85
_MUCH_LOSS, _LITTLE_LOSS = 0.10, 0.02
_LOSS_PACKETS = 50  # that are looked at together: two lost of twenty are an accident
_LOSS_WINDOW_S = 2.0
_QUEUED_S = 0.15  # beyond the quickest round trip of BASE_S: a queue, and no jitter
_BASE_S = 30.0
_LOWER_EVERY_S = 1.0
_DRAIN_S = 3.0  # that nothing is raised after lowering: a queue that was always there shows itself by its end
_SENT_S = 2.0
_FIRST_PATIENCE_S = 5.0
_LONGEST_PATIENCE_S = 80.0
_FAR_S = 0.1  # a round trip that is too long to wait for what was lost
_LOSSLESS_S = 30.0
_MOST_LOSS_TO_COPY = 0.05


@dataclass(frozen=True)
class ReceiverReport:
    """Hold a receiver's report: packets that it lost, of how many, both since the beginning; NaN for no round trip."""

    lost: int
    expected: int
    round_trip_s: float = math.nan


class RateControl:
    """Hold what one receiver's link carries."""

    def __init__(self) -> None:
        self._estimate_bps = math.inf
        self._reported_bps = math.inf  # a limit of reports alone
        self._limited = False
        self._sent: deque[tuple[float, int]] = deque()
        self._need_bps = float(_USUAL_BPS)
        self._reports: deque[tuple[float, ReceiverReport]] = deque()
        self._round_trips: deque[tuple[float, float]] = deque()
        self._queued = 0
        self._loss = 0.0
        self._lost_s = -math.inf
        self._lowered_s = -math.inf
        self._raised_s = -math.inf
        self._roomy_since_s = math.inf
        self._freed_s = -math.inf
        self._patience_s = _FIRST_PATIENCE_S

    def limit_bps(self) -> float:
        """Return how many bits a second of pictures may be sent; infinity without a limit."""
        if not self._limited:
            return math.inf
        return max(FLOOR_BPS, min(_PICTURES_SHARE * self._estimate_bps, self._reported_bps))

    def wants_copies(self, now_s: float) -> bool:
        """Tell whether each packet is worth sending twice.

        It is where packets were lost lately, though the link is not full, and asking for them again takes long.
        """
        far = bool(self._round_trips) and min(self._round_trips, key=_second)[1] > _FAR_S
        lossy = now_s - self._lost_s < _LOSSLESS_S and self._loss < _MOST_LOSS_TO_COPY
        return far and lossy and not self._limited

    def on_sent(self, size_bytes: int, now_s: float) -> None:
        """Take that so much was sent, copies included."""
        self._sent.append((now_s, size_bytes))
        while now_s - self._sent[0][0] > _SENT_S:
            self._sent.popleft()
        if not self._limited and now_s - self._sent[0][0] > _SENT_S / 2:
            self._need_bps = max(self._need_bps, self._sent_bps(now_s))

    def on_estimate(self, bitrate_bps: float, now_s: float) -> None:
        """Take the receiver's estimate of what it can receive."""
        fell = bitrate_bps < self._estimate_bps
        self._estimate_bps = bitrate_bps
        if fell and bitrate_bps < self._sent_bps(now_s):
            self._limit(now_s)
        self._let_go(now_s)

    def on_report(self, report: ReceiverReport, now_s: float) -> None:
        """Take a report of loss and of a round trip."""
        self._take_loss(report, now_s)
        full = self._loss > _MUCH_LOSS
        if not math.isnan(report.round_trip_s):
            full |= self._queues(report.round_trip_s, now_s)
        if full:
            self._lower(now_s)
        elif self._limited:
            self._raise(now_s)
        self._let_go(now_s)

    def _take_loss(self, report: ReceiverReport, now_s: float) -> None:
        reports = self._reports
        if reports and report.lost > reports[-1][1].lost:
            self._lost_s = now_s
        reports.append((now_s, report))
        while len(reports) > 2 and _enough(reports[1], reports[-1]):
            reports.popleft()
        expected = report.expected - reports[0][1].expected
        lost = report.lost - reports[0][1].lost
        self._loss = max(0, lost) / expected if expected >= _LOSS_PACKETS else 0.0

    def _queues(self, round_trip_s: float, now_s: float) -> bool:
        """Take a round trip; returns whether this one and the last were long."""
        trips = self._round_trips
        trips.append((now_s, round_trip_s))
        while now_s - trips[0][0] > _BASE_S:
            trips.popleft()
        shortest_s = min(trips, key=_second)[1]
        self._queued = self._queued + 1 if round_trip_s > shortest_s + _QUEUED_S else 0
        return self._queued >= 2

    def _lower(self, now_s: float) -> None:
        if now_s - self._lowered_s < _LOWER_EVERY_S:
            return
        self._limit(now_s)
        factor = min(_LOWER, 1.0 - self._loss / 2) if self._loss > _MUCH_LOSS else _LOWER
        self._reported_bps = max(FLOOR_BPS, factor * min(self.limit_bps(), self._sent_bps(now_s)))
        self._lowered_s = self._raised_s = now_s
        self._reports.clear()
        self._loss = 0.0

    def _raise(self, now_s: float) -> None:
        elapsed_s = min(1.0, now_s - self._raised_s)
        self._raised_s = now_s
        if self._loss < _LITTLE_LOSS and now_s - self._lowered_s > _DRAIN_S:
            self._reported_bps *= _RAISE**elapsed_s

    def _limit(self, now_s: float) -> None:
        if not self._limited:
            self._limited = True
            soon = now_s - self._freed_s < 2 * self._patience_s
            self._patience_s = min(2 * self._patience_s, _LONGEST_PATIENCE_S) if soon else _FIRST_PATIENCE_S
        self._roomy_since_s = math.inf

    def _let_go(self, now_s: float) -> None:
        """End the limit where it has been far above all that a scene takes for a while."""
        if not self._limited or self.limit_bps() < _ROOMY * self._need_bps:
            self._roomy_since_s = math.inf
            return
        self._roomy_since_s = min(self._roomy_since_s, now_s)
        if now_s - self._roomy_since_s >= self._patience_s:
            self._limited, self._freed_s = False, now_s
            self._reported_bps = math.inf

    def _sent_bps(self, now_s: float) -> float:
        recent = [(at_s, size) for at_s, size in self._sent if now_s - at_s <= _SENT_S]
        if not recent:
            return 0.0
        return 8 * sum(size for _, size in recent) / max(_SENT_S / 2, now_s - recent[0][0])


def _second(pair: tuple[float, float]) -> float:
    return pair[1]


def _enough(first: tuple[float, ReceiverReport], last: tuple[float, ReceiverReport]) -> bool:
    """Tell whether these two reports are far enough apart to say how much is lost between them."""
    apart = last[1].expected - first[1].expected
    return apart >= _LOSS_PACKETS and last[0] - first[0] >= _LOSS_WINDOW_S
