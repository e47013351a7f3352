"""Count a press for a word to one's partners once: it is told several times, because messages may be lost. Pure."""

from __future__ import annotations

from collections import OrderedDict
from enum import Enum, auto

from mart.runtime.rate_limit import RateLimit

MAX_PER_S = 2
_REMEMBERED = 8


class PressVerdict(Enum):
    """Tell what comes of a press."""

    SAID = auto()
    KNOWN = auto()  # it has been said
    TOO_SOON = auto()


class CueFilter:
    """Remember the presses of one seat's holder, and let each through once."""

    def __init__(self) -> None:
        self._rate = RateLimit(MAX_PER_S)
        self._known: OrderedDict[float, PressVerdict] = OrderedDict()

    def judge(self, press_us: float, now_s: float) -> PressVerdict:
        """Tell what comes of this press; one too many stays so, however often it is told."""
        if press_us not in self._known:
            allowed = self._rate.allows(now_s)
            self._known[press_us] = PressVerdict.KNOWN if allowed else PressVerdict.TOO_SOON
            if len(self._known) > _REMEMBERED:
                self._known.popitem(last=False)
            return PressVerdict.SAID if allowed else PressVerdict.TOO_SOON
        return self._known[press_us]
