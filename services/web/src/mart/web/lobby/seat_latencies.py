"""The newest report of each seat's motion to photon. Pure; times are monotonic seconds."""

from __future__ import annotations

from collections import OrderedDict

from mart.protocol.messages import Event

_MAX_SEATS = 256
_FRESH_S = 10.0  # it is told once a second


class SeatLatencies:
    """The newest latency report of each seat that somebody looks at, for at most 256 seats."""

    def __init__(self) -> None:
        self._by_seat: OrderedDict[tuple[str, str], tuple[Event.Latency, float]] = OrderedDict()

    def see(self, room: str, latency: Event.Latency, now_s: float) -> None:
        """Keep the report of the seat of `latency.arm` in `room` instead of its older one."""
        self._by_seat[room, latency.arm] = latency, now_s
        self._by_seat.move_to_end((room, latency.arm))
        if len(self._by_seat) > _MAX_SEATS:
            self._by_seat.popitem(last=False)

    def fresh(self, now_s: float) -> list[tuple[str, Event.Latency]]:
        """Return each seat's report with its room, by room and arm; none of a seat that nobody looks at any more."""
        fresh = {key: latency for key, (latency, at_s) in self._by_seat.items() if now_s - at_s < _FRESH_S}
        return [(room, fresh[room, arm]) for room, arm in sorted(fresh)]
