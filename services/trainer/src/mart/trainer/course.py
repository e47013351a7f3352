"""The course of a training: stages after each other, one update at a time, and all that a continuation needs.

Nothing here is random: what an update draws follows from the seed and the update's number (mart.trainer.noise).
Weights, their averages and the optimiser's moments are therefore the whole state.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from mart.protocol.errors import Corrupt
from mart.trainer.average import Average
from mart.trainer.data.windows import Batch, Windows
from mart.trainer.nets.build import Networks
from mart.trainer.nets.family import Hierarchy, Losses
from mart.trainer.noise import Noise, UpdateNoise
from mart.trainer.presets import Hyperparameters


@dataclass(frozen=True)
class Stage:
    """A part of the course: which weights learn, from what, for how many updates."""

    name: str
    updates: int
    weights: Mapping[str, Tensor]  # by their names in Networks
    losses: Callable[[Batch, Noise], Losses]


def stages(networks: Networks, sizes: Hyperparameters, *, has_base: bool) -> list[Stage]:
    """`has_base`: planner and actor are there already, and only a residual is to be learned."""
    model, weights = networks.model, dict(networks.named_parameters())
    residual = {name: weight for name, weight in weights.items() if name.startswith("model.residual.")}
    base = {name: weight for name, weight in weights.items() if name not in residual}
    found = [] if has_base else [Stage("base", sizes.updates, base, model.base_losses)]
    if isinstance(model, Hierarchy) and residual:
        found.append(Stage("residual", sizes.residual_updates, residual, model.residual_losses))
    return found


class Course:
    """`updates` counts those that were made, over all stages."""

    def __init__(
        self,
        networks: Networks,
        windows: Windows,
        stages: Sequence[Stage],
        sizes: Hyperparameters,
        *,
        seeds: Sequence[int],
        dtype: torch.dtype,
    ) -> None:
        """`dtype`: of matrix products. The networks' device is the windows'."""
        self.networks, self.seeds, self.updates = networks, tuple(seeds), 0
        self.updates_in_all = sum(stage.updates for stage in stages)
        self._windows, self._stages, self._sizes, self._dtype = windows, list(stages), sizes, dtype
        self._enter()

    @property
    def marks(self) -> frozenset[int]:
        """After how many updates there is a checkpoint: evenly spaced, the last one included."""
        count = self._sizes.checkpoints
        return frozenset(math.ceil(self.updates_in_all * (i + 1) / count) for i in range(count))

    @property
    def is_over(self) -> bool:
        return self.updates >= self.updates_in_all

    @property
    def stage(self) -> Stage:
        """The present one; the last one when all are over."""
        return self._at()[0]

    def update(self) -> Losses:
        """One step of every model that is learning."""
        stage, done = self._at()
        device = self._windows.device
        noise = UpdateNoise(self.seeds, self.updates, device)
        batch = self._windows.take(noise.integers(self._windows.count, self._sizes.batch_size))
        with torch.autocast(device.type, self._dtype, enabled=self._dtype != torch.float32):
            losses = stage.losses(batch, noise)
        self._optimizer.zero_grad(set_to_none=True)
        losses.total.backward()
        for group in self._optimizer.param_groups:
            group["lr"] = self._learning_rate(done / stage.updates)
        self._optimizer.step()
        self.updates += 1
        if self._average is not None:
            self._average.follow(done + 1)
        if done + 1 == stage.updates:
            self._leave(stage)
        return losses

    def acting(self) -> dict[str, Tensor]:
        """The weights that act, by name: the averages, where weights are averaged."""
        return self.networks.state_dict() | ({} if self._average is None else self._average.values)

    def state(self) -> dict[str, Tensor]:
        """What `restore` takes."""
        moments = self._optimizer.state_dict()["state"]
        parts: dict[str, Mapping[str, Tensor]] = {
            "networks": self.networks.state_dict(),
            "optimizer": {f"{i}.{key}": value for i, of in moments.items() for key, value in of.items()},
            "average": {} if self._average is None else self._average.values,
        }
        return {f"{part}.{name}": value for part, named in parts.items() for name, value in named.items()}

    def restore(self, updates: int, state: Mapping[str, Tensor]) -> None:
        """Goes on after so many updates. Raises Corrupt where the state is not this course's."""
        parts: dict[str, dict[str, Tensor]] = {"networks": {}, "optimizer": {}, "average": {}}
        try:
            for name, value in state.items():
                part, rest = name.split(".", 1)
                parts[part][rest] = value
            self.networks.load_state_dict(parts["networks"])
            self.updates = updates
            self._enter()
            self._load_moments(parts["optimizer"])
            if self._average is not None:
                for name, value in self._average.values.items():
                    value.copy_(parts["average"][name])
        except (RuntimeError, KeyError, ValueError) as error:
            raise Corrupt(
                f"What was kept after {updates} updates does not fit this run ({error}); start a new one."
            ) from error

    def _at(self) -> tuple[Stage, int]:
        """The present stage and how many of its updates are done."""
        done = self.updates
        for stage in self._stages[:-1]:
            if done < stage.updates:
                return stage, done
            done -= stage.updates
        return self._stages[-1], done

    def _enter(self) -> None:
        weights = self.stage.weights
        for name, weight in self.networks.named_parameters():
            weight.requires_grad_(name in weights)
        # Adam as robomimic uses it: no decay of weights, no clipping of gradients.
        self._optimizer = torch.optim.Adam(weights.values(), self._sizes.learning_rate, fused=True)
        self._average = None if self._sizes.ema is None else Average(weights, self._sizes.ema)

    def _leave(self, stage: Stage) -> None:
        """The averages become the weights: what comes after builds on what acts."""
        if self._average is not None:
            with torch.no_grad():
                for name, weight in stage.weights.items():
                    weight.copy_(self._average.values[name])
        if not self.is_over:
            self._enter()

    def _load_moments(self, named: Mapping[str, Tensor]) -> None:
        state = self._optimizer.state_dict()
        moments: dict[int, dict[str, Tensor]] = {}
        for name, value in named.items():
            index, key = name.split(".", 1)
            moments.setdefault(int(index), {})[key] = value
        self._optimizer.load_state_dict(state | {"state": moments})

    def _learning_rate(self, part: float) -> float:
        """After this part of the stage's updates, 0 … 1."""
        falls = self._sizes.schedule == "cosine"
        return self._sizes.learning_rate * (0.5 * (1 + math.cos(math.pi * part)) if falls else 1.0)
