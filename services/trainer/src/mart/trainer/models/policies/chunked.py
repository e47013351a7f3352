"""The flow baseline at run time: the first few actions of a chunk, then a new chunk."""

from __future__ import annotations

import torch
from torch import Tensor

from mart.trainer.models.checkpoint import CheckpointRecord
from mart.trainer.models.flow_policy_net import FlowPolicyNet
from mart.trainer.models.networks import Networks
from mart.trainer.models.policies.trained import TrainedPolicy
from mart.trainer.models.rng import WorldRng


class ChunkedPolicy(TrainedPolicy):
    """Does the first few actions of a chunk, then draws a new chunk."""

    def __init__(self, record: CheckpointRecord, networks: Networks, device: torch.device) -> None:
        super().__init__(record, networks, device)
        assert isinstance(networks.model, FlowPolicyNet)
        self._nets = networks.model
        self._execute = min(record.hyperparameters.flow_execute, record.hyperparameters.flow_chunk)
        self._forget()

    def _forget(self) -> None:
        self._tick = 0
        self._before: Tensor | None = None  # what was seen a tick ago; at first, the present
        self._chunk = torch.empty(0)

    def _act(self, obs: Tensor, rng: WorldRng) -> Tensor:
        at = self._tick % self._execute
        if at == 0:
            before = obs if self._before is None else self._before
            self._chunk = self._nets.chunk(torch.stack((before, obs), 1), rng)
        self._tick, self._before = self._tick + 1, obs
        return self._chunk[:, at]
