"""The picture of docs/networks.md: each way of advancing a world in each network, two people."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl

mpl.use("svg")
import matplotlib.pyplot as plt

_TITLES = ("Real-time factor", "Age of the applied command, ms", "Success")
_COLORS = {"barrier": "#0072b2", "request_reply": "#d55e00", "hold_last": "#767676"}
_NAMES = {"barrier": "Barrier", "request_reply": "Request and reply", "hold_last": "Hold last"}


def draw(path: Path, cells: Mapping[tuple[str, str, int], tuple[float, ...]], people: int = 2) -> None:
    """`cells`: the three figures by way, network and number of people."""
    networks = list(dict.fromkeys(network for _, network, _ in cells))
    mpl.rcParams |= {"svg.hashsalt": "mart", "font.family": "sans-serif", "svg.fonttype": "none"}
    figure, axes = plt.subplots(1, len(_TITLES), figsize=(11, 3), layout="constrained")
    for index, (axis, title) in enumerate(zip(axes, _TITLES, strict=True)):
        for offset, way in enumerate(_NAMES):
            heights = [cells[way, network, people][index] for network in networks]
            places = [place + 0.27 * (offset - 1) for place in range(len(networks))]
            axis.bar(places, heights, 0.25, color=_COLORS[way], label=_NAMES[way])
        axis.set_title(title, fontsize=10)
        axis.set_xticks(range(len(networks)), networks, rotation=30, fontsize=8)
        axis.spines[["top", "right"]].set_visible(False)
    axes[0].legend(fontsize=8, frameon=False, loc="lower left")
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
