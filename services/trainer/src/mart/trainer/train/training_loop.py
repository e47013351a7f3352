"""The training loop: phases after each other, one update at a time, and all that a continuation needs.

Nothing here is random: what an update draws follows from the seed and the update's number (mart.trainer.models.rng).
Weights, their averages and the optimiser's moments are therefore the whole state.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from mart.protocol.errors import Corrupt
from mart.trainer.data.windows import WindowBatch, Windows
from mart.trainer.models.hyperparameters import Hyperparameters
from mart.trainer.models.losses import Losses
from mart.trainer.models.networks import Networks
from mart.trainer.models.rng import Rng, UpdateRng
from mart.trainer.train.ema import EMA

_HELD_OUT_DRAW = 2**62  # no update has this number


@dataclass(frozen=True)
class Phase:
    """A part of a training: which weights learn, from what, for how many updates."""

    name: str
    updates: int
    weights: Mapping[str, Tensor]  # by their names in Networks
    losses: Callable[[WindowBatch, Rng], Losses]


def training_phases(networks: Networks, sizes: Hyperparameters, *, has_base: bool) -> list[Phase]:
    """Return the phases of a training.

    has_base: planner and actor are there already, and only a residual is to be learned.
    """
    model, weights = networks.model, dict(networks.named_parameters())
    residual = {name: weight for name, weight in weights.items() if name.startswith("model.residual.")}
    base = {name: weight for name, weight in weights.items() if name not in residual}
    found = [] if has_base else [Phase("base", sizes.updates, base, model.base_losses)]
    if residual:
        found.append(Phase("residual", sizes.residual_updates, residual, model.residual_losses))
    return found


def learning_rate(sizes: Hyperparameters, part: float) -> float:
    """Return the rate after this part of a phase's updates, 0 … 1: with the schedule `cosine` it falls to 0."""
    falls = sizes.schedule == "cosine"
    return sizes.learning_rate * (0.5 * (1 + math.cos(math.pi * part)) if falls else 1.0)


class TrainingLoop:
    """Train networks on windows, phase by phase. `updates` counts those that were made, over all phases."""

    def __init__(
        self,
        networks: Networks,
        windows: Windows,
        phases: Sequence[Phase],
        sizes: Hyperparameters,
        *,
        seeds: Sequence[int],
        dtype: torch.dtype,
        held_out: Windows | None = None,
    ) -> None:
        """Start or continue a training. dtype: of matrix products. The networks' device is the windows'.

        held_out: windows that are not learned from, to measure the losses on.
        """
        self.networks, self.seeds, self.updates = networks, tuple(seeds), 0
        self.updates_in_all = sum(phase.updates for phase in phases)
        self._windows, self._phases, self._sizes, self._dtype = windows, list(phases), sizes, dtype
        self._held_out = held_out
        self._enter()

    @property
    def checkpoint_steps(self) -> frozenset[int]:
        """Return after how many updates there is a checkpoint: evenly spaced, the last one included."""
        count = self._sizes.checkpoints
        return frozenset(math.ceil(self.updates_in_all * (i + 1) / count) for i in range(count))

    @property
    def is_over(self) -> bool:
        """Whether all updates were made."""
        return self.updates >= self.updates_in_all

    @property
    def phase(self) -> Phase:
        """The present phase; the last one when all are over."""
        return self._at()[0]

    def update(self) -> Losses:
        """Make one step of every model that is learning, and return its losses."""
        phase, done = self._at()
        device = self._windows.device
        rng = UpdateRng(self.seeds, self.updates, device)
        batch = self._windows.take(rng.integers(self._windows.count, self._sizes.batch_size))
        with torch.autocast(device.type, self._dtype, enabled=self._dtype != torch.float32):
            losses = phase.losses(batch, rng)
        self._optimizer.zero_grad(set_to_none=True)
        losses.total.backward()
        for group in self._optimizer.param_groups:
            group["lr"] = learning_rate(self._sizes, done / phase.updates)
        self._optimizer.step()
        self.updates += 1
        if self._ema is not None:
            self._ema.update(done + 1)
        if done + 1 == phase.updates:
            self._leave(phase)
        return losses

    @torch.no_grad()
    def held_out_losses(self) -> Losses | None:
        """Return the present phase's losses on what is not learned from, always on the same draw of it, or None."""
        if self._held_out is None:
            return None
        device = self._held_out.device
        rng = UpdateRng(self.seeds, _HELD_OUT_DRAW, device)
        batch = self._held_out.take(rng.integers(self._held_out.count, self._sizes.batch_size))
        with torch.autocast(device.type, self._dtype, enabled=self._dtype != torch.float32):
            return self.phase.losses(batch, rng)

    def acting(self) -> dict[str, Tensor]:
        """Return the weights that act, by name: the averages, where weights are averaged."""
        return self.networks.state_dict() | ({} if self._ema is None else self._ema.values)

    def state(self) -> dict[str, Tensor]:
        """Return all that a continuation needs: what `restore` takes."""
        moments = self._optimizer.state_dict()["state"]
        parts: dict[str, Mapping[str, Tensor]] = {
            "networks": self.networks.state_dict(),
            "optimizer": {f"{i}.{key}": value for i, of in moments.items() for key, value in of.items()},
            "average": {} if self._ema is None else self._ema.values,
        }
        return {f"{part}.{name}": value for part, named in parts.items() for name, value in named.items()}

    def restore(self, updates: int, state: Mapping[str, Tensor]) -> None:
        """Go on after so many updates. Raises Corrupt where the state is not of such a training."""
        parts: dict[str, dict[str, Tensor]] = {"networks": {}, "optimizer": {}, "average": {}}
        try:
            for name, value in state.items():
                part, rest = name.split(".", 1)
                parts[part][rest] = value
            self.networks.load_state_dict(parts["networks"])
            self.updates = updates
            self._enter()
            self._load_moments(parts["optimizer"])
            if self._ema is not None:
                for name, value in self._ema.values.items():
                    value.copy_(parts["average"][name])
        except (RuntimeError, KeyError, ValueError) as error:
            raise Corrupt(
                f"What was kept after {updates} updates does not fit this run ({error}); start a new one."
            ) from error

    def _at(self) -> tuple[Phase, int]:
        """Return the present phase and how many of its updates are done."""
        done = self.updates
        for phase in self._phases[:-1]:
            if done < phase.updates:
                return phase, done
            done -= phase.updates
        return self._phases[-1], done

    def _enter(self) -> None:
        weights = self.phase.weights
        for name, weight in self.networks.named_parameters():
            weight.requires_grad_(name in weights)
        # Adam as robomimic uses it, unless weights are to decay: no clipping of gradients.
        sizes = self._sizes
        self._optimizer = torch.optim.AdamW(
            weights.values(), sizes.learning_rate, weight_decay=sizes.weight_decay, fused=True
        )
        self._ema = None if self._sizes.ema is None else EMA(weights, self._sizes.ema)

    def _leave(self, phase: Phase) -> None:
        """Make the averages the weights: what comes after builds on what acts."""
        if self._ema is not None:
            with torch.no_grad():
                for name, weight in phase.weights.items():
                    weight.copy_(self._ema.values[name])
        if not self.is_over:
            self._enter()

    def _load_moments(self, named: Mapping[str, Tensor]) -> None:
        state = self._optimizer.state_dict()
        moments: dict[int, dict[str, Tensor]] = {}
        for name, value in named.items():
            index, key = name.split(".", 1)
            moments.setdefault(int(index), {})[key] = value
        self._optimizer.load_state_dict(state | {"state": moments})
