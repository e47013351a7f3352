"""Say how bad a network is, one way at a time; the profiles that tests and benchmarks share.

What the profiles hold is judgement, not measurement: a cable, a good wireless network, a telephone, another continent
(Europe to New York is about a third of that delay), and a link that is dark for two seconds now and then.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields, replace

from mart.protocol.errors import InvalidInput


@dataclass(frozen=True)
class Impairment:
    """Hold what one direction of a link does to packets; 0 means without.

    delay_ms, jitter_ms: the delay is uniform within `delay_ms` ± `jitter_ms` and correlated over `memory_ms`, so that
    packets of one burst stay together. loss_percent: lost for good, `burst` packets at a time on average. rate_kbit_s:
    packets queue behind each other, and are lost beyond `queue_ms`. reorder_percent: overtaken, `late_ms` late.
    Every `stall_every_ms` packets are held for `stall_ms`; every `outage_every_ms` they are lost for `outage_ms`.
    """

    delay_ms: float = 0.0
    jitter_ms: float = 0.0
    memory_ms: float = 100.0
    loss_percent: float = 0.0
    burst: float = 1.0
    rate_kbit_s: float = 0.0
    queue_ms: float = 200.0
    reorder_percent: float = 0.0
    late_ms: float = 10.0
    stall_every_ms: float = 0.0
    stall_ms: float = 0.0
    outage_every_ms: float = 0.0
    outage_ms: float = 0.0

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if not math.isfinite(value) or value < 0:
                raise InvalidInput(f"{name} was {value}; it is a finite number, at least 0.")
        if self.loss_percent > 100 or self.reorder_percent > 100:
            raise InvalidInput("More than 100 percent were to be lost or overtaken; at most 100 can be.")
        if self.burst < 1:
            raise InvalidInput(f"Bursts of {self.burst} packets were asked for; one packet is the shortest.")
        if self.jitter_ms > self.delay_ms:
            raise InvalidInput(
                f"A jitter of {self.jitter_ms} ms was asked for; it is at most the delay, {self.delay_ms} ms."
            )


@dataclass(frozen=True)
class LinkProfile:
    """Hold both directions. up: from the person to the platform; down: from the platform to the person."""

    up: Impairment = Impairment()
    down: Impairment = Impairment()

    def changed(self, settings: Iterable[str]) -> LinkProfile:
        """Return it with settings like `delay_ms=20`, for both directions, or `up.loss_percent=3`, for one.

        Raises InvalidInput for any other text.
        """
        up: dict[str, float] = {}
        down: dict[str, float] = {}
        for setting in settings:
            side, name, value = _parsed(setting)
            if side != "down":
                up[name] = value
            if side != "up":
                down[name] = value
        return LinkProfile(replace(self.up, **up), replace(self.down, **down))


def _parsed(setting: str) -> tuple[str, str, float]:
    name, _, text = setting.partition("=")
    side, _, field = name.rpartition(".")
    known = [one.name for one in fields(Impairment)]
    if side not in ("", "up", "down") or field not in known:
        raise InvalidInput(
            f"{setting!r} was given; a setting is [up.|down.]NAME=NUMBER, NAME one of {', '.join(known)}."
        )
    try:
        return side, field, float(text)
    except ValueError as error:
        raise InvalidInput(f"{setting!r} was given; after the = stands a number.") from error


_LAN = Impairment(delay_ms=0.2, jitter_ms=0.1)
_WIFI = Impairment(
    delay_ms=3, jitter_ms=2.5, memory_ms=20, loss_percent=0.2, burst=3, queue_ms=100,
    stall_every_ms=15_000, stall_ms=80,
)  # fmt: skip
_CELLULAR = Impairment(
    memory_ms=60, loss_percent=0.2, burst=4, queue_ms=300, stall_every_ms=20_000, stall_ms=150
)
_OCEAN = Impairment(
    delay_ms=150, jitter_ms=30, loss_percent=1, burst=2, rate_kbit_s=20_000, reorder_percent=0.2, late_ms=15
)
_DARK = Impairment(delay_ms=20, jitter_ms=5, outage_every_ms=20_000, outage_ms=2_000)

PROFILES: Mapping[str, LinkProfile] = {
    "none": LinkProfile(),
    "lan": LinkProfile(_LAN, _LAN),
    "wifi": LinkProfile(replace(_WIFI, rate_kbit_s=40_000), replace(_WIFI, rate_kbit_s=60_000)),
    "4g": LinkProfile(
        replace(_CELLULAR, delay_ms=30, jitter_ms=15, rate_kbit_s=8_000),
        replace(_CELLULAR, delay_ms=25, jitter_ms=10, rate_kbit_s=25_000),
    ),
    "intercontinental": LinkProfile(_OCEAN, _OCEAN),
    "outage": LinkProfile(_DARK, _DARK),
}
