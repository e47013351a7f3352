"""A trained model as it acts: what all kinds have in common."""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np
import torch
from torch import Tensor

from mart.protocol.errors import InvalidInput, NotFound
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.models.checkpoint import CheckpointRecord
from mart.trainer.models.networks import Networks
from mart.trainer.models.policies.policy import Array, Policy
from mart.trainer.models.rng import WorldRng


class TrainedPolicy(ABC):
    """Implements Policy for all arms of a checkpoint."""

    def __init__(self, record: CheckpointRecord, networks: Networks, device: torch.device) -> None:
        self.record = record
        self.layout = ObservationLayout(record.arms, record.layout)
        self._normaliser = networks.normaliser
        self._device = device
        self._rng = WorldRng(0, 0, device)
        self._worlds = 0

    @property
    def task(self) -> str:
        return self.record.task

    @property
    def control_hz(self) -> float:
        return self.record.control_hz

    @property
    def arms(self) -> tuple[str, ...]:
        return self.record.arms

    @property
    def arm_kinds(self) -> tuple[str, ...]:
        return self.record.arm_kinds

    @property
    def needs(self) -> tuple[str, ...]:
        return self.layout.names

    def begin(self, worlds: int, seed: int) -> None:
        if worlds < 1 or not 0 <= seed < 2**63:
            raise InvalidInput(
                f"{worlds} worlds and the seed {seed} were given; give 1 or more, and 0 or more."
            )
        self._worlds, self._rng = worlds, WorldRng(seed, worlds, self._device)
        self._forget()

    def act(self, observations: Mapping[str, Array]) -> Array:
        vector = self.layout.vector(observations)
        if len(vector) != self._worlds:
            raise InvalidInput(
                f"Observations of {len(vector)} worlds were given; begin was told {self._worlds}."
            )
        with torch.inference_mode():
            obs = self._normaliser(torch.from_numpy(vector).to(self._device))
            actions = self._act(obs[None], self._rng)
        return actions[0].cpu().numpy().astype(np.float64)

    def only(self, arm: str) -> Policy:
        if arm not in self.arms:
            raise NotFound.named("arm", arm, self.arms)
        model = self.record.model
        if "joint" in {model.planner, model.actor, model.residual}:
            raise InvalidInput(
                f"{self.record.name} drives {', '.join(self.arms)} together and cannot take {arm} alone; "
                "give it all of them, or use a model that is per-arm throughout, such as d-HBC."
            )
        return SingleArmPolicy(copy.copy(self), arm)  # the same weights, a memory of its own

    @abstractmethod
    def _forget(self) -> None:
        """Forget what was remembered of the episode before."""

    @abstractmethod
    def _act(self, obs: Tensor, rng: WorldRng) -> Tensor:
        """Act for one tick. obs: float32[1, worlds, D], normalised → [1, worlds, arms, 7]."""


class SingleArmPolicy:
    """A policy whose arms do not see each other, as one of them: what the others see is told as nothing."""

    def __init__(self, policy: TrainedPolicy, arm: str) -> None:
        self._policy = policy
        self._index = policy.arms.index(arm)
        self.arms = (arm,)
        self.needs = policy.layout.names_of(arm)

    @property
    def task(self) -> str:
        return self._policy.task

    @property
    def control_hz(self) -> float:
        return self._policy.control_hz

    @property
    def arm_kinds(self) -> tuple[str, ...]:
        return self._policy.arm_kinds

    def begin(self, worlds: int, seed: int) -> None:
        self._policy.begin(worlds, seed)

    def act(self, observations: Mapping[str, Array]) -> Array:
        worlds = len(next(iter(observations.values()), ()))
        nothing = {s.name: np.zeros((worlds, *s.shape)) for s in self._policy.layout.fields}
        own = {name: observations[name] for name in self.needs if name in observations}
        missing = [name for name in self.needs if name not in own]
        if missing:
            raise InvalidInput(
                f"The observation {missing[0]} is missing; {self.arms[0]}'s are needed, by name."
            )
        return self._policy.act(nothing | own)[:, [self._index]]

    def only(self, arm: str) -> Policy:
        if arm not in self.arms:
            raise NotFound.named("arm", arm, self.arms)
        return self
