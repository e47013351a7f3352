"""The grid's models at run time: a subgoal every `window` ticks, and an LSTM that begins anew as often.

Both are part of the method, not economy: the LSTM was trained on sequences of `window` ticks towards one subgoal
(robomimic's HBC and BC_RNN do the same).
"""

from __future__ import annotations

import torch
from torch import Tensor

from mart.trainer.models.checkpoint import CheckpointRecord
from mart.trainer.models.hierarchical_bc import HierarchicalBC
from mart.trainer.models.layers.actors import Memory
from mart.trainer.models.networks import Networks
from mart.trainer.models.policies.trained import TrainedPolicy
from mart.trainer.models.rng import WorldRng


class HierarchicalPolicy(TrainedPolicy):
    """Draws a subgoal every `window` ticks and acts towards it."""

    def __init__(self, record: CheckpointRecord, networks: Networks, device: torch.device) -> None:
        super().__init__(record, networks, device)
        assert isinstance(networks.model, HierarchicalBC)
        self._nets = networks.model
        self._window = record.hyperparameters.window
        self._forget()

    def _forget(self) -> None:
        self._tick = 0
        self._goal: Tensor | None = None
        self._memory: Memory = []

    def _act(self, obs: Tensor, rng: WorldRng) -> Tensor:
        if self._tick % self._window == 0:
            self._goal = self._nets.plan(obs, rng)
            self._memory = self._nets.start(obs.shape[1])
        self._tick += 1
        actions, self._memory = self._nets.act(obs, self._goal, self._memory, rng)
        return actions
