"""Decide for each packet of one direction when it arrives, or that it is lost. Pure: `now_ns` in, a time out.

In this order: an outage or a loss, else a queue behind what is being sent, then the delay with its jitter, then stalls.
Order is kept but for packets that are overtaken.
"""

from __future__ import annotations

import enum
import math
import random

from tools.netrelay.impairment import Impairment

_MS = 1_000_000  # ns


class PacketLoss(enum.Enum):
    """Name why a packet is lost."""

    CHANCE = "lost"
    OUTAGE = "lost_in_outage"
    QUEUE = "lost_in_queue"


class PacketScheduler:
    """Send packets through one direction of a link. `impairment` may be changed at any time."""

    def __init__(self, impairment: Impairment, seed: int, began_ns: int = 0) -> None:
        """Begin at `began_ns`, to which repeated stalls and outages are aligned: they end at multiples."""
        self.impairment = impairment
        self._random = random.Random(seed)
        self._began_ns = began_ns
        self._dark_until_ns = self._held_until_ns = 0
        self._sent_ns = 0  # when the link has finished sending what it has
        self._newest_ns = 0  # when the newest packet in order arrives
        self._drift = 0.0  # first-order autoregressive, standard normal
        self._drifted_ns = began_ns
        self._in_loss = False

    def interrupt(self, now_ns: int, *, outage_s: float = 0.0, stall_s: float = 0.0) -> None:
        """Lose all packets for `outage_s`, or hold them for `stall_s`, from now on."""
        self._dark_until_ns = max(self._dark_until_ns, now_ns + round(outage_s * 1e9))
        self._held_until_ns = max(self._held_until_ns, now_ns + round(stall_s * 1e9))

    def schedule(self, now_ns: int, size_bytes: int) -> int | PacketLoss:
        """Return when a packet that is sent now arrives, nanoseconds of the same clock, or why it does not."""
        bad = self.impairment
        if now_ns < self._dark_until_ns or self._left_ns(now_ns, bad.outage_every_ms, bad.outage_ms):
            return PacketLoss.OUTAGE
        if self._is_lost():
            return PacketLoss.CHANCE
        arrives_ns = now_ns
        if bad.rate_kbit_s:
            begins_ns = max(now_ns, self._sent_ns)
            if begins_ns - now_ns > bad.queue_ms * _MS:
                return PacketLoss.QUEUE
            arrives_ns = self._sent_ns = begins_ns + round(size_bytes * 8 * _MS / bad.rate_kbit_s)
        arrives_ns += round((bad.delay_ms + self._jitter_ms(now_ns)) * _MS)
        arrives_ns = max(arrives_ns, self._held_until_ns)
        arrives_ns += self._left_ns(arrives_ns, bad.stall_every_ms, bad.stall_ms)
        if bad.reorder_percent and self._random.random() * 100 < bad.reorder_percent:
            return arrives_ns + round(bad.late_ms * _MS)
        self._newest_ns = max(arrives_ns, self._newest_ns)
        return self._newest_ns

    def _left_ns(self, at_ns: int, every_ms: float, for_ms: float) -> int:
        """Return what is left at `at_ns` of an interruption that comes back every `every_ms`; 0 between them."""
        if not every_ms or not for_ms:
            return 0
        left_ns = round(every_ms * _MS) - (at_ns - self._began_ns) % round(every_ms * _MS)
        return left_ns if left_ns <= for_ms * _MS else 0

    def _is_lost(self) -> bool:
        """Decide by two states (Gilbert 1960): runs last `burst` packets on average, `loss_percent` over all."""
        bad = self.impairment
        if not bad.loss_percent:
            return False
        if bad.loss_percent >= 100:
            return True
        leave = 1 / bad.burst
        share = bad.loss_percent / 100
        chance = 1 - leave if self._in_loss else min(1.0, leave * share / (1 - share))
        self._in_loss = self._random.random() < chance
        return self._in_loss

    def _jitter_ms(self, now_ns: int) -> float:
        if not self.impairment.jitter_ms:
            return 0.0
        kept = math.exp(-(now_ns - self._drifted_ns) / (max(self.impairment.memory_ms, 1e-3) * _MS))
        self._drift = kept * self._drift + math.sqrt(1 - kept * kept) * self._random.gauss(0, 1)
        self._drifted_ns = now_ns
        return self.impairment.jitter_ms * math.erf(self._drift / math.sqrt(2))
