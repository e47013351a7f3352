"""How far a training has come, as it is told while it goes on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class TrainingProgress:
    """How far a training has come. losses: by name, means over seeds since the last report."""

    updates: int
    updates_in_all: int
    phase: str
    updates_per_s: float
    losses: Mapping[str, float]
