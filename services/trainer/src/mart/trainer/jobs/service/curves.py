"""Read a run's `metrics.jsonl`: its curves, thinned, and how far it has come."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from mart.protocol.messages import Curve
from mart.runtime.json_lines import read_json_lines, read_last_json_line

MAX_POINTS = 500
MAX_CURVES = 32
_NO_CURVES = {"updates", "at_ns"}


def read_curves(path: Path, since_updates: int = 0) -> list[Curve]:
    """Return every number of the file over updates, after `since_updates`; of many points some, and always the last."""
    points: dict[str, list[tuple[int, float]]] = {}
    for _, row in read_json_lines(path):
        if row is not None and _is_point(row) and row["updates"] > since_updates:
            for name, value in _numbers(row):
                points.setdefault(name, []).append((row["updates"], value))
    return [_curve(name, found) for name, found in sorted(points.items())[:MAX_CURVES]]


def newest_row(path: Path) -> dict[str, Any]:
    """Return the last whole line; empty where there is none."""
    row = read_last_json_line(path)
    return row if row is not None and _is_point(row) else {}


def _is_point(row: dict[str, Any]) -> bool:
    return isinstance(row.get("updates"), int)


def _numbers(row: dict[str, Any]) -> Iterable[tuple[str, float]]:
    return (
        (name, float(value))
        for name, value in row.items()
        if name not in _NO_CURVES and isinstance(value, int | float) and math.isfinite(value)
    )


def _curve(name: str, points: Sequence[tuple[int, float]]) -> Curve:
    every = math.ceil(len(points) / MAX_POINTS)
    thinned = points[(len(points) - 1) % every :: every]
    return Curve(name=name, updates=[at for at, _ in thinned], values=[value for _, value in thinned])
