"""What a gateway and its seat processes say to each other. Light: a gateway never imports what a seat needs."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

from mart.protocol.messages import OPERATOR_HUMAN, OPERATOR_POLICY

SERVED = (OPERATOR_HUMAN, OPERATOR_POLICY)  # whose seats have a process, and with it a picture
WARM = b"warm\n"  # said by a process that has imported everything and waits for its assignment


@dataclass(frozen=True)
class SeatAssignment:
    """Which seat a process serves: one line on its standard input."""

    room: str
    arm: str

    @property
    def id(self) -> str:
        """In the liveliness token."""
        return f"{self.room}-{self.arm}"

    def encode(self) -> bytes:
        return json.dumps(asdict(self)).encode() + b"\n"

    @classmethod
    def decode(cls, line: bytes) -> SeatAssignment:
        return cls(**json.loads(line))
