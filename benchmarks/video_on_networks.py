"""Pictures over bad networks, in a real Chromium: standstills where packets are lost, and delay where the link is thin.

Each network is tried twice: as it is, and with the receiver's reports ignored. It takes root and /dev/net/tun.

    python benchmarks/video_on_networks.py [SECONDS]      how long each is watched: 20 s; 600 shows that nothing grows
"""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np
from report import Bar, report
from support.moving_scene import PERIOD_S, moving_scene
from support.networked_video import Displayed, show

from mart.protocol.errors import Unavailable

FRAMES_PER_S = 20.0
SECONDS = 20.0
MOST_FREEZES_PER_20_S = 1.0
MOST_GROWTH_MS = 50.0
MOST_GROWTH_MB = 30.0


@dataclass(frozen=True)
class Network:
    """Options of `netrelay run`."""

    name: str
    options: tuple[str, ...]


LOSSY = Network("intercontinental", ("--profile", "intercontinental"))
THIN = tuple(
    Network(
        f"{rate}_kbit_s",
        ("--set", "delay_ms=20", "--set", f"down.rate_kbit_s={rate}", "--set", "down.queue_ms=1000"),
    )
    for rate in (2000, 500)
)


def figures(network: Network, displayed: Displayed) -> dict[str, float]:
    """Return what a network's run says, named after it."""
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


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS
    pictures = list(moving_scene(FRAMES_PER_S, int(PERIOD_S * FRAMES_PER_S)))
    metrics: dict[str, float] = {}
    peer: dict[str, float] = {}
    try:
        for network in (LOSSY, *THIN):
            for follows, found in ((True, metrics), (False, peer)):
                displayed = show(pictures, FRAMES_PER_S, network.options, seconds, follows=follows)
                found.update(figures(network, displayed))
    except Unavailable as error:
        sys.exit(f"Left out: {error}")
    bars = [Bar.at_most("freezes", metrics[f"{LOSSY.name}_freezes_per_20_s"], MOST_FREEZES_PER_20_S)]
    for network in THIN:
        bars += [
            Bar.at_most(f"{network.name} growth", metrics[f"{network.name}_delay_growth_ms"], MOST_GROWTH_MS),
            Bar.at_most(f"{network.name} MB", metrics[f"{network.name}_memory_growth_mb"], MOST_GROWTH_MB),
        ]
    report("video_on_networks", metrics, peer, bars)


if __name__ == "__main__":
    main()
