"""Show how a seat's pictures do: from hand to picture, drawing, encoding, and what was left out."""

from __future__ import annotations

from prometheus_client import Counter, Gauge, Summary

from mart.protocol.messages import Event
from mart.runtime.metrics import REGISTRY
from mart.teleop_gateway.served_seats import SeatAddress

_SEAT = ("room", "arm")

MOTION_TO_PHOTON = Gauge(
    "mart_seat_motion_to_photon_seconds",
    "From a hand's frame to its effect on the screen, of the newest reports: statistic is p50 or p95.",
    (*_SEAT, "statistic"),
    registry=REGISTRY,
)
STAGE = Gauge(
    "mart_seat_stage_seconds",
    "Median of each stage between hand and screen, of the newest reports.",
    (*_SEAT, "stage"),
    registry=REGISTRY,
)
PICTURE_RATE = Gauge(
    "mart_seat_picture_rate_hertz", "Pictures drawn a second; 0 where none are.", _SEAT, registry=REGISTRY
)
PICTURE_CPU = Gauge(
    "mart_seat_picture_cpu_seconds",
    "Of a core, to draw and encode a picture at full size; 0 where none are drawn.",
    _SEAT,
    registry=REGISTRY,
)
WATCHERS = Gauge(
    "mart_seat_peers", "Connections of browsers and phones to this seat.", _SEAT, registry=REGISTRY
)
NO_PICTURE = Gauge(
    "mart_seat_no_picture", "1 while the seat cannot be drawn, else 0.", _SEAT, registry=REGISTRY
)

# One process serves one seat, and its video's thread knows no names: these tell by their process.
RENDER = Summary("mart_seat_render_seconds", "What drawing a picture took.", registry=REGISTRY)
ENCODE = Summary(
    "mart_seat_encode_seconds", "What encoding a picture took, in all streams together.", registry=REGISTRY
)
SKIPPED = Counter(
    "mart_seat_skipped_pictures",
    "Pictures that were not drawn because a newer one came first.",
    registry=REGISTRY,
)


class SeatMetrics:
    """Take a seat's figures where they are known."""

    def __init__(self, seat: SeatAddress) -> None:
        self._seat = (seat.room, seat.arm)

    def latency(self, measured: Event.Latency) -> None:
        """Take what was measured from motion to photon."""
        MOTION_TO_PHOTON.labels(*self._seat, "p50").set(measured.p50_ms * 1e-3)
        MOTION_TO_PHOTON.labels(*self._seat, "p95").set(measured.p95_ms * 1e-3)
        for stage in measured.stages:
            STAGE.labels(*self._seat, stage.name).set(stage.p50_ms * 1e-3)

    def drawn(self, *, rate_hz: float, picture_s: float, failed: bool, peers: int) -> None:
        """Take how the seat is drawn, and for how many."""
        PICTURE_RATE.labels(*self._seat).set(rate_hz)
        PICTURE_CPU.labels(*self._seat).set(picture_s)
        NO_PICTURE.labels(*self._seat).set(failed)
        WATCHERS.labels(*self._seat).set(peers)
