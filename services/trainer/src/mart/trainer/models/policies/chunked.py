"""Models of chunks at run time: the first few actions of a chunk, then a new chunk.

Or an average of chunks (Zhao et al., arXiv 2304.13705, "temporal ensembling"): a new one every tick, and what all that
reach this tick say of it is averaged, the oldest with weight 1, each newer one with exp(-chunk_ensemble) of the next
older one's. Where chunks say absolute targets, each is turned into a step from where the tool is now
(data/tool_targets.py).
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from mart.trainer.models.checkpoint import CheckpointRecord
from mart.trainer.models.chunk_policy_net import ChunkPolicyNet
from mart.trainer.models.networks import Networks, tool_targets
from mart.trainer.models.policies.trained import TrainedPolicy
from mart.trainer.models.rng import WorldRng


@dataclass(frozen=True)
class _Chunk:
    """What was said in tick `begun`, on seeing obs, [S, B, D]: numbers, [S, chunk, B, arms, 7]."""

    begun: int
    obs: Tensor
    numbers: Tensor


class ChunkedPolicy(TrainedPolicy):
    """Does the first few actions of a chunk, then draws a new chunk."""

    def __init__(self, record: CheckpointRecord, networks: Networks, device: torch.device) -> None:
        super().__init__(record, networks, device)
        assert isinstance(networks.model, ChunkPolicyNet)
        self._nets, sizes = networks.model, record.hyperparameters
        self._ensemble = sizes.chunk_ensemble
        self._every = sizes.executed if self._ensemble is None else 1
        self._kept = 1 if self._ensemble is None else sizes.chunk
        self._targets = tool_targets(record.model, sizes, record.task, self.layout, record.arm_kinds)
        self._forget()

    def _forget(self) -> None:
        self._tick = 0
        self._before: Tensor | None = None  # what was seen a tick ago; at first, the present
        self._chunks: tuple[_Chunk, ...] = ()  # the oldest first

    def _act(self, obs: Tensor, rng: WorldRng) -> Tensor:
        if self._tick % self._every == 0:
            before = obs if self._before is None else self._before
            chunk = self._nets.chunk(torch.stack((before, obs), 1), rng)
            self._chunks = (*self._chunks, _Chunk(self._tick, obs, chunk))[-self._kept :]
        said = torch.stack([self._said(chunk, obs) for chunk in self._chunks])
        self._tick, self._before = self._tick + 1, obs
        return self._nets.corrected(obs, self._averaged(said))

    def _said(self, chunk: _Chunk, obs: Tensor) -> Tensor:
        """Return the actions of this tick by one chunk: [S, B, arms, 7]."""
        numbers = chunk.numbers[:, self._tick - chunk.begun]
        if self._targets is None:
            return numbers
        now, start = (self._targets.poses(self._normaliser.restore(of)) for of in (obs, chunk.obs))
        return self._targets.actions(numbers, now, start)

    def _averaged(self, said: Tensor) -> Tensor:
        """Average what chunks say of one tick, the oldest first: [N, S, B, arms, 7] → [S, B, arms, 7]."""
        if self._ensemble is None:
            return said[-1]
        weights = torch.exp(-self._ensemble * torch.arange(len(said), device=said.device))
        return torch.tensordot(weights / weights.sum(), said, 1)
