"""Emulate a link worse than the one at hand: delay, jitter and loss from a seed, for emulated phones."""

from __future__ import annotations

import asyncio
import random
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class LinkProfile:
    """Describe one way of a link: delay, up to `jitter_s` more (uniform), and `loss`, the share of messages lost."""

    delay_s: float = 0.0
    jitter_s: float = 0.0
    loss: float = 0.0


class EmulatedLink:
    """Carry messages as a bad link does. They may overtake each other, as on the unordered channels it stands for."""

    def __init__(self, profile: LinkProfile, seed: int = 0) -> None:
        self._profile = profile
        self._random = random.Random(seed)

    def carry(self, deliver: Callable[[], None]) -> None:
        """Call `deliver` when the message arrives, on the running event loop; never, where it is lost."""
        profile = self._profile
        if self._random.random() < profile.loss:
            return
        delay_s = profile.delay_s + profile.jitter_s * self._random.random()
        if delay_s == 0.0:
            deliver()
        else:
            asyncio.get_running_loop().call_later(delay_s, deliver)
