"""Policies small enough to know what they will do."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput, NotFound
from mart.trainer.models.policies.policy import ACTION_SIZE, Policy

Array = NDArray[np.float64]
TASK = "two_arm_multi_cube_lifting"


class Wanderer:
    """Draws its actions, and keeps what it gave: `given`, newest last, each of shape (arms, 7)."""

    def __init__(
        self,
        arms: tuple[str, ...] = ("arm0", "arm1"),
        *,
        joint: bool = False,
        task: str = TASK,
        hz: float = 20.0,
    ) -> None:
        self.task, self.control_hz, self.arms, self._joint = task, hz, arms, joint
        self.arm_kinds: tuple[str, ...] = ()
        self.needs = tuple(f"{arm}/tool_position_in_base" for arm in arms)
        self.given: list[Array] = []
        self.seeds: list[int] = []
        self.parts: dict[str, Wanderer] = {}
        self.spoilt: float | None = None

    def begin(self, worlds: int, seed: int) -> None:
        assert worlds == 1
        self.seeds.append(seed)
        self._random = np.random.default_rng(seed)

    def act(self, observations: Mapping[str, Array]) -> Array:
        assert all(observations[name].shape == (1, 3) for name in self.needs)
        actions = np.stack([one_action(self._random) for _ in self.arms])
        if self.spoilt is not None:
            actions[0, 0] = self.spoilt
        self.given.append(actions)
        return actions[np.newaxis]

    def only(self, arm: str) -> Policy:
        if arm not in self.arms:
            raise NotFound.named("arm", arm, self.arms)
        if self._joint and len(self.arms) > 1:
            raise InvalidInput(f"This model drives {', '.join(self.arms)} together.")
        return self.parts.setdefault(arm, Wanderer((arm,), task=self.task, hz=self.control_hz))


def one_action(random: np.random.Generator) -> Array:
    """Any of those that the sim applies unshortened: a step and a turn within their limits, a gripper."""
    action = np.zeros(ACTION_SIZE)
    for part in (slice(0, 3), slice(3, 6)):
        direction = random.normal(size=3)
        action[part] = random.uniform(0.0, 0.3) * direction / np.linalg.norm(direction)
    action[6] = random.uniform(-1.0, 1.0)
    return action
