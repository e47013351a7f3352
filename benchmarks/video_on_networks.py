"""Pictures over bad networks, in a real Chromium: standstills where packets are lost, and delay where the link is thin.

Each network is tried twice: as it is, and with the receiver's reports ignored. It takes root and /dev/net/tun.

    python benchmarks/video_on_networks.py [SECONDS [NETWORK …]]      how long each is watched: 20 s
    python benchmarks/video_on_networks.py 600 2000_kbit_s            ten minutes: nothing grows
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from report import Bar, report
from support.moving_scene import PERIOD_S, moving_scene
from support.networked_video import show
from support.watching_page import Displayed

from mart.protocol.errors import Unavailable

SECONDS = 20.0
MOST_FREEZES_PER_20_S = 1.0
MOST_GROWTH_MS = 50.0
MOST_GROWTH_MB = 30.0


@dataclass(frozen=True)
class Network:
    """options: of `netrelay run`. frames_per_s: of the room."""

    name: str
    frames_per_s: float
    options: tuple[str, ...]
    lossy: bool = False


def _thin(kbit_s: int, frames_per_s: float) -> Network:
    options = ("--set", "delay_ms=20", "--set", f"down.rate_kbit_s={kbit_s}", "--set", "down.queue_ms=1000")
    return Network(f"{kbit_s}_kbit_s", frames_per_s, options)


NETWORKS = (
    Network("intercontinental", 60.0, ("--profile", "intercontinental"), lossy=True),
    _thin(2000, 60.0),
    _thin(500, 20.0),
)


def figures(network: Network, displayed: Displayed) -> dict[str, float]:
    """Return what a network's run says, named after it; of one that showed nothing, that alone."""
    if len(displayed.at_ms) < 2:
        return {f"{network.name}_displayed_per_s": 0.0}
    third = len(displayed.delay_ms) // 3
    first, last = displayed.delay_ms[:third], displayed.delay_ms[-third:]
    seconds = (displayed.at_ms[-1] - displayed.at_ms[0]) / 1e3
    found = {
        "delay_p50_ms": float(np.percentile(displayed.delay_ms, 50)),
        "delay_p95_ms": float(np.percentile(displayed.delay_ms, 95)),
        "delay_growth_ms": float(np.median(last) - np.median(first)),
        "freezes_per_20_s": 20 * displayed.freezes() / seconds,
        "displayed_per_s": len(displayed.at_ms) / seconds,
        "kbit_s": displayed.kbit_s,
        "memory_growth_mb": displayed.memory_mb[1] - displayed.memory_mb[0],
    }
    return {f"{network.name}_{name}": value for name, value in found.items()}


def bars_of(network: Network, found: Mapping[str, float]) -> list[Bar]:
    """Return what a network's figures must reach."""

    def at_most(figure: str, most: float) -> Bar:
        return Bar.at_most(f"{network.name} {figure}", found[f"{network.name}_{figure}"], most)

    if network.lossy:
        return [at_most("freezes_per_20_s", MOST_FREEZES_PER_20_S)]
    return [at_most("delay_growth_ms", MOST_GROWTH_MS), at_most("memory_growth_mb", MOST_GROWTH_MB)]


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS
    networks = [network for network in NETWORKS if not sys.argv[2:] or network.name in sys.argv[2:]]
    metrics: dict[str, float] = {}
    peer: dict[str, float] = {}
    bars: list[Bar] = []
    try:
        for network in networks:
            rate = network.frames_per_s
            pictures = list(moving_scene(rate, int(PERIOD_S * rate)))
            for follows, found in ((True, metrics), (False, peer)):
                displayed = show(pictures, rate, network.options, seconds, follows=follows)
                found.update(figures(network, displayed))
                print("followed" if follows else "ignored", figures(network, displayed), flush=True)
            bars += bars_of(network, metrics)
    except Unavailable as error:
        print(f"Left out: {error}")
        return
    report("video_on_networks", metrics, peer, bars)


if __name__ == "__main__":
    main()
