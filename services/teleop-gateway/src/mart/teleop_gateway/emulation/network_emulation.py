"""A link worse than the one at hand: delay, jitter and loss from a seed, for emulated phones."""

from __future__ import annotations

import asyncio
import random
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class LinkProfile:
    """One way: a message takes `delay_s` plus up to `jitter_s` more (uniform), or is lost with probability `loss`."""

    delay_s: float = 0.0
    jitter_s: float = 0.0
    loss: float = 0.0


class EmulatedLink:
    """Messages may overtake each other, as on the unordered channels that this stands for."""

    def __init__(self, profile: LinkProfile, seed: int = 0) -> None:
        self._profile = profile
        self._random = random.Random(seed)

    def carry(self, deliver: Callable[[], None]) -> None:
        """Calls `deliver` when the message arrives, on the running event loop; never, where it is lost."""
        profile = self._profile
        if self._random.random() < profile.loss:
            return
        delay_s = profile.delay_s + profile.jitter_s * self._random.random()
        if delay_s == 0.0:
            deliver()
        else:
            asyncio.get_running_loop().call_later(delay_s, deliver)
