"""Show how a gateway's seats do: how many have a process, and how often one was lost."""

from __future__ import annotations

from prometheus_client import Counter, Gauge

from mart.runtime.metrics import REGISTRY

SEATS = Gauge("mart_gateway_seats", "Seats that this gateway serves, a process each.", registry=REGISTRY)
LOST_PROCESSES = Counter(
    "mart_gateway_lost_seat_processes",
    "Processes of seats that ended while their seat was held.",
    registry=REGISTRY,
)
