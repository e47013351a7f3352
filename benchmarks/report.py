"""Prints a benchmark's figures as a table and writes them to benchmarks/results/NAME.json.

Absolute figures change from machine to machine; bars compare figures of one run.
"""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any

RESULTS = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Bar:
    """A figure and what it must reach."""

    name: str
    value: float
    bar: float
    holds: bool

    @classmethod
    def at_most(cls, name: str, value: float, bar: float) -> Bar:
        return cls(name, value, bar, value <= bar)

    @classmethod
    def at_least(cls, name: str, value: float, bar: float) -> Bar:
        return cls(name, value, bar, value >= bar)


def report(name: str, metrics: dict[str, Any], peer: dict[str, Any], bars: list[Bar]) -> None:
    """metrics: ours, peer: the same taken beside; both flat, with units in the names."""
    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / f"{name}.json"
    document = {"metrics": metrics, "peer": peer, "machine": machine(), "bars": [asdict(bar) for bar in bars]}
    path.write_text(json.dumps(document, indent=2) + "\n")
    width = max(len(key) for key in (*metrics, *peer, *(bar.name for bar in bars)))
    for title, figures in (("ours", metrics), ("peer", peer)):
        for key, value in figures.items():
            print(f"{title}  {key:<{width}}  {_readable(value)}")
    for bar in bars:
        verdict = "holds" if bar.holds else "MISSED"
        print(f"bar   {bar.name:<{width}}  {_readable(bar.value)} ({_readable(bar.bar)}) {verdict}")
    print(f"written to {path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path}")


def spread(name: str, values: Sequence[float]) -> dict[str, float]:
    """Median, smallest and largest of repeated figures."""
    return {name: median(values), f"{name}_min": min(values), f"{name}_max": max(values)}


def machine() -> dict[str, Any]:
    """What the figures were taken on."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "load_1min": os.getloadavg()[0],
    }


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    if not info.is_file():
        return platform.processor()
    names = [
        line.partition(":")[2].strip()
        for line in info.read_text().splitlines()
        if line.startswith("model name")
    ]
    return names[0] if names else platform.machine()


def _readable(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
