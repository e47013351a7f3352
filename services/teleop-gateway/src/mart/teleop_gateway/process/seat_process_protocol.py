"""Encode what a gateway and its seat processes say to each other on standard input and output."""

from __future__ import annotations

import json
from dataclasses import asdict

from mart.teleop_gateway.served_seats import SeatAddress

WARM = b"warm\n"  # said by a process that has imported everything and waits for its seat


def encode_assignment(seat: SeatAddress) -> bytes:
    """Return the line that gives a process its seat."""
    return json.dumps(asdict(seat)).encode() + b"\n"


def decode_assignment(line: bytes) -> SeatAddress:
    """Return the seat that this line gives."""
    return SeatAddress(**json.loads(line))
