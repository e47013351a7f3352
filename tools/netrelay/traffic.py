"""Count what passed one direction of a relay, and how late it was written: the relay's own error."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from tools.netrelay.packet_scheduler import PacketLoss


@dataclass
class Traffic:
    """Count packets. late: written after they were due, which is this machine's doing and not the network's."""

    taken: int = 0
    passed: int = 0
    bytes_passed: int = 0
    lost: Counter[PacketLoss] = field(default_factory=Counter)
    _delay_ns: int = 0
    _late_ns: int = 0
    _latest_ns: int = 0

    def on_written(self, size_bytes: int, late_ns: int, took_ns: int) -> None:
        """Count a packet that went on, `took_ns` after it came."""
        self.passed += 1
        self.bytes_passed += size_bytes
        self._delay_ns += took_ns
        self._late_ns += late_ns
        self._latest_ns = max(self._latest_ns, late_ns)

    def summary(self) -> dict[str, float]:
        """Return all of it, times in milliseconds, for JSON."""
        passed = max(1, self.passed)
        return {
            "taken": self.taken,
            "passed": self.passed,
            **{reason.value: self.lost[reason] for reason in PacketLoss},
            "bytes_passed": self.bytes_passed,
            "mean_delay_ms": round(self._delay_ns / passed / 1e6, 3),
            "mean_late_ms": round(self._late_ns / passed / 1e6, 3),
            "most_late_ms": round(self._latest_ns / 1e6, 3),
        }
