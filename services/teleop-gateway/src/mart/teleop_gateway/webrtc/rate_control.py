"""Decide what a receiver's link carries, by what the receiver reports. Pure: reports and `now_s` in, a limit out.

There is no limit until a queue shows that one is needed: round trips (RFC 3550) that are all longer than they were, or
that are longer than ways are, while much less is estimated than is sent (a link that was full from the first packet
on), or a tenth of the packets lost (draft-ietf-rmcat-gcc-02). How low it must be, the receiver's estimate says (REMB,
draft-alvestrand-rmcat-remb-03): a browser knows what came while packets queued. Alone it is not believed. Where delay
varies by tens of milliseconds it falls again and again, by what is sent and not by what could be.

A limit rises by 8 % a second: at once to what the receiver estimates, and after some patience beyond it, to try. A
trial that fails doubles the patience.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from itertools import pairwise

FLOOR_BPS = 150_000  # ten pictures of 640 x 496 a second, in which a cube's spots can still be counted
_PICTURES_SHARE = 0.9  # of an estimate: the rest is for what else the link carries
_SENT_S = 2.0
_LEAST_NEED_BPS = 600_000
_ROOMY = 1.6  # times the most that was ever sent: then no limit is needed any more
_USED = 0.5  # of a limit: a link of which less is used is not known to carry more

_MUCH_LOSS, _LITTLE_LOSS = 0.10, 0.02
_LOSS_PACKETS = 50  # that are looked at together: two lost of twenty are an accident
_LOSS_WINDOW_S = 2.0
_LEAST_REPORTS = 4
_MOST_KEPT = 200  # reports; a receiver may send as many as it likes, also while nothing is sent to it
_QUEUED_S = (
    0.1  # that the quickest round trip of _NOW_S is longer than the quickest of _BASE_S: a queue, no jitter
)
_NOW_S, _BASE_S = 2.0, 30.0
_LONGEST_WAY_S = 0.5  # there and back: a geostationary satellite's takes as long, all others are quicker
_MUCH_LESS = 0.7  # of what is sent

_LOWER, _LOWER_EVERY_S = 0.85, 2.0
_RAISE = 1.08  # a second
_DRAIN_S = 3.0  # that nothing is raised after lowering: a queue that was always there shows itself by its end
_FIRST_PATIENCE_S, _LONGEST_PATIENCE_S = 10.0, 160.0

_FAR_S = 0.1  # a round trip that is too long to wait for what was lost
_LOSSLESS_S = 30.0
_MOST_LOSS_TO_COPY = 0.05
_LEAST_TO_COPY_BPS = 800_000


@dataclass(frozen=True)
class ReceiverReport:
    """Hold a receiver's report: packets that it lost, of how many, both since the beginning; NaN for no round trip."""

    lost: int
    expected: int
    round_trip_s: float = math.nan


class RateControl:
    """Hold what one receiver's link carries."""

    def __init__(self) -> None:
        self._limit_bps = math.inf
        self._estimate_bps = math.inf
        self._sent: deque[tuple[float, int]] = deque()
        self._need_bps = float(_LEAST_NEED_BPS)
        self._reports: deque[tuple[float, ReceiverReport]] = deque(maxlen=_MOST_KEPT)
        self._round_trips: deque[tuple[float, float]] = deque(maxlen=_MOST_KEPT)
        self._loss = 0.0
        self._lost_s = -math.inf
        self._wants_copies = False
        self._lowered_s = -math.inf
        self._judged_s = -math.inf
        self._tries = False  # more than was estimated
        self._patience_s = _FIRST_PATIENCE_S

    def limit_bps(self) -> float:
        """Return how many bits a second of pictures may be sent; infinity without a limit."""
        return self._limit_bps / 2 if self.copies else self._limit_bps

    @property
    def copies(self) -> bool:
        """Whether each packet is worth sending twice.

        It is where packets were lost lately, asking for them again takes long, and half of what the link carries is
        enough: a picture that is coarser is better than one that stands still.
        """
        return self._wants_copies and self._limit_bps >= _LEAST_TO_COPY_BPS

    def on_sent(self, size_bytes: int, now_s: float) -> None:
        """Take that so much was sent, copies included."""
        self._sent.append((now_s, size_bytes))
        while now_s - self._sent[0][0] > _SENT_S:
            self._sent.popleft()

    def on_estimate(self, bitrate_bps: float, now_s: float) -> None:
        """Take the receiver's estimate of what it can receive."""
        self._estimate_bps = bitrate_bps
        self._judge(now_s)

    def on_report(self, report: ReceiverReport, now_s: float) -> None:
        """Take a report of loss and of a round trip."""
        self._take_loss(report, now_s)
        if not math.isnan(report.round_trip_s):
            self._round_trips.append((now_s, report.round_trip_s))
        while self._round_trips and now_s - self._round_trips[0][0] > _BASE_S:
            self._round_trips.popleft()
        far = self._quickest_s(_BASE_S, now_s) > _FAR_S
        lossy = now_s - self._lost_s < _LOSSLESS_S and self._loss < _MOST_LOSS_TO_COPY
        self._wants_copies = far and lossy
        self._judge(now_s)

    def _take_loss(self, report: ReceiverReport, now_s: float) -> None:
        reports = self._reports
        if reports and report.lost > reports[-1][1].lost:
            self._lost_s = now_s
        reports.append((now_s, report))
        while len(reports) > _LEAST_REPORTS and _enough(reports[1], reports[-1]):
            reports.popleft()
        expected = report.expected - reports[0][1].expected
        losses = [later.lost - earlier.lost for (_, earlier), (_, later) in pairwise(reports)]
        lost = sum(losses) - max(losses, default=0)  # an outage is in one report, a link that is full in all
        self._loss = max(0, lost) / expected if expected >= _LOSS_PACKETS else 0.0

    def _judge(self, now_s: float) -> None:
        """Lower or raise the limit, or leave it."""
        elapsed_s, self._judged_s = min(1.0, now_s - self._judged_s), now_s
        sent_bps = self._sent_bps(now_s)
        self._need_bps = max(self._need_bps, sent_bps)
        if self._loss > _MUCH_LOSS or self._is_queueing(sent_bps, now_s):
            if now_s - self._lowered_s >= _LOWER_EVERY_S:
                self._lower(min(self._limit_bps, sent_bps), now_s)
        elif self._loss < _LITTLE_LOSS and sent_bps > _USED * self._limit_bps:
            self._raise(_RAISE**elapsed_s, now_s)

    def _is_queueing(self, sent_bps: float, now_s: float) -> bool:
        round_trip_s = self._quickest_s(_NOW_S, now_s)
        since_the_first = round_trip_s > _LONGEST_WAY_S and self._estimate_bps < _MUCH_LESS * sent_bps
        return since_the_first or round_trip_s - self._quickest_s(_BASE_S, now_s) > _QUEUED_S

    def _lower(self, now_bps: float, now_s: float) -> None:
        to_bps = _LOWER * now_bps if math.isinf(self._estimate_bps) else _PICTURES_SHARE * self._estimate_bps
        if self._loss > _MUCH_LOSS:
            to_bps = min(to_bps, (1.0 - self._loss / 2) * now_bps)
        if to_bps >= now_bps:
            return  # the receiver gets more than that: it is not our packets that queue
        self._limit_bps = max(FLOOR_BPS, to_bps)
        self._lowered_s = now_s
        self._patience_s = min(2 * self._patience_s, _LONGEST_PATIENCE_S) if self._tries else self._patience_s
        self._tries = False
        self._reports.clear()
        self._loss = 0.0

    def _raise(self, factor: float, now_s: float) -> None:
        since_s = now_s - self._lowered_s
        estimated_bps = _PICTURES_SHARE * self._estimate_bps
        if since_s < _DRAIN_S:
            return
        if since_s >= self._patience_s:
            self._tries |= self._limit_bps > estimated_bps
        elif self._limit_bps >= estimated_bps:
            return
        self._limit_bps *= factor
        if self._limit_bps > _ROOMY * self._need_bps:
            self._tries = True
            self._limit_bps = math.inf

    def _quickest_s(self, window_s: float, now_s: float) -> float:
        """Return the quickest round trip of the last `window_s`; 0 where there was none."""
        trips_s = [trip_s for at_s, trip_s in self._round_trips if now_s - at_s <= window_s]
        return min(trips_s, default=0.0)

    def _sent_bps(self, now_s: float) -> float:
        recent = [(at_s, size_bytes) for at_s, size_bytes in self._sent if now_s - at_s <= _SENT_S]
        if not recent:
            return 0.0
        return 8 * sum(size_bytes for _, size_bytes in recent) / max(_SENT_S / 2, now_s - recent[0][0])


def _enough(first: tuple[float, ReceiverReport], last: tuple[float, ReceiverReport]) -> bool:
    """Tell whether these two reports are far enough apart to say how much is lost between them."""
    apart = last[1].expected - first[1].expected
    return apart >= _LOSS_PACKETS and last[0] - first[0] >= _LOSS_WINDOW_S
