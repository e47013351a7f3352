"""Bound what one peer may say. Pure."""

from __future__ import annotations

from mart.runtime.rate_limit import RateLimit

MAX_PER_S = 60  # a browser sends 50: packets of 20 ms
MAX_BYTES = 400  # of a packet: 160 kbit/s, five times what a voice is asked to take


class SpeechBounds:
    """Let through what a browser that is spoken into sends; a flood is cut down to that."""

    def __init__(self) -> None:
        self._rate = RateLimit(MAX_PER_S)

    def allow(self, opus: bytes, now_s: float) -> bool:
        """Tell whether a packet may pass. What is empty is no speech."""
        return 0 < len(opus) <= MAX_BYTES and self._rate.allows(now_s)
