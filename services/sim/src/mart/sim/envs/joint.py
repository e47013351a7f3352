"""Offer a task as a Gymnasium environment: one agent that sees everything and moves every arm."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from mart.protocol.control_rate import DEFAULT_CONTROL_HZ
from mart.protocol.pose import Pose
from mart.protocol.tasks import Task
from mart.render import Image
from mart.sim.envs.episode_runner import (
    MAX_SEED,
    RENDER_MODES,
    Action,
    EnvOptions,
    EpisodeRunner,
    Observations,
    action_space,
    checked_seed,
    observation_space,
)


class JointEnv(gymnasium.Env[dict[str, Any], Action]):
    """Step a task as one agent: actions of shape (arms, 7) in [-1, 1]; observations are all that any operator sees.

    The reward is 1 for the step that completes the task and 0 for every other. An episode terminates with success or
    irrecoverable failure, and is truncated at the task's horizon. `info`: subtasks (name → done), success, failed.
    """

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "render_fps": DEFAULT_CONTROL_HZ}  # noqa: RUF012

    def __init__(self, task: str, **options: Any) -> None:
        """Build the environment of a task; the options are the fields of `EnvOptions`. Raises as `EpisodeRunner`."""
        chosen = EnvOptions(**options)
        self._runner = EpisodeRunner(task, chosen)
        self.render_mode = chosen.render_mode
        self.metadata = {**type(self).metadata, "render_fps": chosen.control_hz}
        self.observation_space = observation_space(self._runner.task.observations)
        self.action_space = action_space(len(self._runner.task.arms))

    @property
    def task(self) -> Task:
        """The task as data: arms with their bases' poses in the world, subtasks, observations, limits, horizon."""
        return self._runner.task

    def action_for(self, arm: str, target_tool_in_base: Pose, gripper: float) -> NDArray[np.float64]:
        """Return the action, shape (7,), that takes an arm's tool towards a pose in the arm's base frame.

        It goes as far as one step and the workspace allow. gripper: 0 open … 1 closed. Raises NotFound for no such arm.
        """
        return self._runner.action_for(arm, target_tool_in_base, gripper)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin the very episode that `seed` begins in a room; without one, the next seed is drawn."""
        super().reset(seed=seed)
        drawn = int(self.np_random.integers(MAX_SEED)) if seed is None else checked_seed(seed)
        result = self._runner.reset(drawn)
        return result.observations, result.info()

    def step(self, action: Action) -> tuple[Observations, float, bool, bool, dict[str, Any]]:
        """Advance one control period; return observations, reward, terminated, truncated, info."""
        result = self._runner.step(action)
        return result.observations, result.reward, result.terminated, result.truncated, result.info()

    def render(self) -> Image | None:
        """Draw the chosen viewpoint: uint8, shape (height, width, 3); None without a render mode."""
        return self._runner.render()

    def close(self) -> None:
        """Let the renderer go."""
        self._runner.close()
