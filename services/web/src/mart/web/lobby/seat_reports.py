"""The newest report of one kind from each seat. Pure; times are monotonic seconds."""

from __future__ import annotations

from collections import OrderedDict
from typing import Generic, TypeVar

_MAX_SEATS = 256
_FRESH_S = 10.0  # reports are told every few seconds at least, as long as they hold

R = TypeVar("R")


class SeatReports(Generic[R]):
    """The newest report of each seat, for at most 256 seats."""

    def __init__(self) -> None:
        self._by_seat: OrderedDict[tuple[str, str], tuple[R, float]] = OrderedDict()

    def see(self, room: str, arm: str, report: R, now_s: float) -> None:
        """Keep the report of the seat of `arm` in `room` instead of its older one."""
        self._by_seat[room, arm] = report, now_s
        self._by_seat.move_to_end((room, arm))
        if len(self._by_seat) > _MAX_SEATS:
            self._by_seat.popitem(last=False)

    def fresh(self, now_s: float) -> list[tuple[str, R]]:
        """Return each seat's report with its room, by room and arm; none of a seat that has not told for 10 s."""
        fresh = {key: report for key, (report, at_s) in self._by_seat.items() if now_s - at_s < _FRESH_S}
        return [(room, fresh[room, arm]) for room, arm in sorted(fresh)]
