"""Tell how long a message waited on its way, without knowing the sender's clock. Pure.

Sent and arrival times of two clocks differ by an unknown offset and the way itself. Both are in every message, so how
much later one came than the quickest of the last seconds is what it waited: in a queue that a broken link left behind,
behind retransmissions, or in a process that stood still (the queueing delay of LEDBAT, RFC 6817).
"""

from __future__ import annotations

import math

_WINDOW_S = (
    1.0  # the quickest of this window and the one before counts: a clock that was set is followed in two
)


class QueueingDelay:
    """Follow one sender's messages in the order in which they arrive."""

    def __init__(self) -> None:
        self._begun_s = -math.inf
        self._quickest_s = self._quickest_before_s = math.inf

    def waited_s(self, sent_s: float, arrived_s: float) -> float:
        """Take a message in; return how much later it came than the quickest of the last seconds, at least 0.

        sent_s is of the sender's clock, arrived_s of ours. Where nothing came for long, what came before it counts:
        what a link that was broken delivers late is known as late.
        """
        transit_s = arrived_s - sent_s
        if not 0.0 <= arrived_s - self._begun_s <= _WINDOW_S:
            self._quickest_before_s = self._quickest_s
            self._quickest_s, self._begun_s = math.inf, arrived_s
        self._quickest_s = min(self._quickest_s, transit_s)
        return transit_s - min(self._quickest_s, self._quickest_before_s)
