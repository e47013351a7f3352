"""What a run's `metrics.jsonl` says: its curves, thinned, and how far it has come."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from mart.protocol.messages import Curve

MAX_POINTS = 500
MAX_CURVES = 32
_TAIL_BYTES = 4096
_NO_CURVES = {"updates", "at_ns"}


def curves(path: Path, since_updates: int = 0) -> list[Curve]:
    """Every number of the file over updates, after `since_updates`; of many points evenly many, and always the last."""
    points: dict[str, list[tuple[int, float]]] = {}
    for row in _rows(path):
        if row["updates"] > since_updates:
            for name, value in _numbers(row):
                points.setdefault(name, []).append((row["updates"], value))
    return [_curve(name, found) for name, found in sorted(points.items())[:MAX_CURVES]]


def newest(path: Path) -> dict[str, Any]:
    """The last whole line; empty where there is none."""
    if not path.is_file():
        return {}
    with path.open("rb") as file:
        file.seek(max(0, file.seek(0, 2) - _TAIL_BYTES))
        lines = file.read().split(b"\n")
    return next((row for line in reversed(lines) if (row := _row(line)) is not None), {})


def _rows(path: Path) -> Iterator[dict[str, Any]]:
    if path.is_file():
        with path.open("rb") as file:
            yield from (row for line in file if (row := _row(line)) is not None)


def _row(line: bytes) -> dict[str, Any] | None:
    """None for a line that is still being written, or was torn by a kill."""
    try:
        row = json.loads(line)
    except ValueError:
        return None
    return row if isinstance(row, dict) and isinstance(row.get("updates"), int) else None


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
