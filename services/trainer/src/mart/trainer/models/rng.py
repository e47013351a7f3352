"""Random numbers that follow from what they are for, so that nothing about them has to be kept.

A training draws those of an update from (seed, update): stopped and resumed, alone or stacked with other seeds, it
draws the same. A policy draws those of a world from (seed, world), whatever other worlds there are. The generator is
counter-based (Philox: Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", 2011), made for this.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import torch
from numpy.random import Generator, Philox
from torch import Tensor

from mart.trainer.models.layers.stack import Generators


class Rng(Protocol):
    """What a network may draw. M = S * units models, S seeds known to the source."""

    def uniform(self, units: int, batch: int) -> Tensor:
        """Draw float32[M, batch], uniform in [0, 1)."""
        ...

    def normal(self, units: int, batch: int, size: int) -> Tensor:
        """Draw float32[M, batch, size], standard normal."""
        ...


@dataclass(frozen=True)
class Draws:
    """What one batch may draw: a row for each of its windows or worlds, of each of the M models."""

    rng: Rng
    units: int
    batch: int

    def uniform(self) -> Tensor:
        """Draw float32[M, batch], uniform in [0, 1)."""
        return self.rng.uniform(self.units, self.batch)

    def normal(self, size: int) -> Tensor:
        """Draw float32[M, batch, size], standard normal."""
        return self.rng.normal(self.units, self.batch, size)


class UpdateRng:
    """Random numbers of one update: each seed draws for its own models."""

    def __init__(self, seeds: Sequence[int], update: int, device: torch.device) -> None:
        self._generators = [Generator(Philox(key=seed, counter=[0, 0, 0, update])) for seed in seeds]
        self._device = device

    def integers(self, below: int, count: int) -> Tensor:
        """Draw int64[S, count], uniform in [0, below)."""
        return self._stack([one.integers(below, size=count) for one in self._generators])

    def uniform(self, units: int, batch: int) -> Tensor:
        drawn = [one.random((units, batch), dtype=np.float32) for one in self._generators]
        return self._stack(drawn).flatten(0, 1)

    def normal(self, units: int, batch: int, size: int) -> Tensor:
        drawn = [one.standard_normal((units, batch, size), dtype=np.float32) for one in self._generators]
        return self._stack(drawn).flatten(0, 1)

    def _stack(self, drawn: Sequence[np.ndarray]) -> Tensor:
        return torch.from_numpy(np.stack(drawn)).to(self._device, non_blocking=True)


class WorldRng:
    """Random numbers of one episode in each of `worlds` worlds, which are the batch; one seed (S = 1)."""

    def __init__(self, seed: int, worlds: int, device: torch.device) -> None:
        self._generators = [Generator(Philox(key=seed | world << 64)) for world in range(worlds)]
        self._device = device

    def uniform(self, units: int, batch: int) -> Tensor:
        assert batch == len(self._generators)
        drawn = [one.random(units, dtype=np.float32) for one in self._generators]
        return torch.from_numpy(np.stack(drawn, axis=1)).to(self._device)

    def normal(self, units: int, batch: int, size: int) -> Tensor:
        assert batch == len(self._generators)
        drawn = [one.standard_normal((units, size), dtype=np.float32) for one in self._generators]
        return torch.from_numpy(np.stack(drawn, axis=1)).to(self._device)


def weight_generators(seeds: Sequence[int], units: int, part: str) -> Generators:
    """Return a generator for each model, seeded by its seed, its unit and the part of the hierarchy alone."""
    label = int.from_bytes(part.encode(), "little")
    states = [
        np.random.SeedSequence([seed, unit, label]).generate_state(1)[0]
        for seed in seeds
        for unit in range(units)
    ]
    return [torch.Generator().manual_seed(int(state)) for state in states]
