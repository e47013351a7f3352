"""Actors: from what is seen, and a subgoal where there is a planner, to an action, once a tick."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from mart.trainer.models.layers.heads import MeanHead, MixtureHead
from mart.trainer.models.layers.lstm import LSTM, LSTMState
from mart.trainer.models.layers.stack import MLP, Generators, full

Head = MeanHead | MixtureHead
Memory = list[LSTMState]


class Actor(nn.Module):
    """A body that makes features of a sequence of inputs, and a head that makes actions of features."""

    def __init__(self, body: Recurrent | Memoryless, head: Head) -> None:
        super().__init__()
        self.body, self.head = body, head

    def loss(self, inputs: Tensor, actions: Tensor, counted: Tensor | None = None) -> Tensor:
        """Return the loss of each action. inputs: [M, T, B, I], actions: [M, T, B, A] → [M, T, B].

        counted: [M, T, B, A], how much each number of an action counts; 1 each.
        """
        weights = None if counted is None else counted.flatten(1, 2)
        flat = self.head.loss(self.body(inputs).flatten(1, 2), actions.flatten(1, 2), weights)
        return flat.unflatten(1, inputs.shape[1:3])

    def sequence(self, inputs: Tensor, choice: Tensor, noise: Tensor) -> Tensor:
        """Return what it would do in T ticks after each other: [M, T, B, I] → [M, T, B, A].

        choice: [M, T * B] uniform, noise: [M, T * B, A] normal.
        """
        flat = self.head.act(self.body(inputs).flatten(1, 2), choice, noise)
        return flat.unflatten(1, inputs.shape[1:3])

    def step(self, inputs: Tensor, memory: Memory, choice: Tensor, noise: Tensor) -> tuple[Tensor, Memory]:
        """Act for one tick: [M, B, I] → [M, B, A], and what it remembers."""
        features, memory = self.body.step(inputs, memory)
        return self.head.act(features, choice, noise), memory


class Recurrent(nn.Module):
    """An LSTM over the window."""

    def __init__(
        self, inputs: Tensor, generators: Generators, *, width: int, layers: int, dtype: torch.dtype
    ) -> None:
        """Make layers for inputs, bool[M, I], which say which columns are real."""
        super().__init__()
        self.lstm = LSTM(inputs, width, layers, generators, dtype)
        self.features = full(len(inputs), width)

    def forward(self, inputs: Tensor) -> Tensor:
        """Return features, from an empty memory: [M, T, B, I] → [M, T, B, F]."""
        return self.lstm(inputs)

    def start(self, batch: int) -> Memory:
        return self.lstm.start(batch)

    def step(self, inputs: Tensor, memory: Memory) -> tuple[Tensor, Memory]:
        return self.lstm.step(inputs, memory)


class Memoryless(nn.Module):
    """A perceptron of the present."""

    def __init__(self, inputs: Tensor, generators: Generators, *, hidden: Sequence[int]) -> None:
        super().__init__()
        self.features = full(len(inputs), hidden[-1])
        self.net = MLP(inputs, hidden[:-1], self.features, generators)

    def forward(self, inputs: Tensor) -> Tensor:
        return torch.relu(self.net(inputs))

    def start(self, batch: int) -> Memory:
        del batch
        return []

    def step(self, inputs: Tensor, memory: Memory) -> tuple[Tensor, Memory]:
        return self(inputs), memory
