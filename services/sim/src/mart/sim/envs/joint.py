"""A task as a Gymnasium environment: one agent that sees everything and moves every arm."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from mart.render import Image
from mart.sim.envs.course import (
    MAX_SEED,
    RENDER_MODES,
    Course,
    Observations,
    Options,
    action_space,
    checked_seed,
    observation_space,
)


class JointEnv(gymnasium.Env[dict[str, Any], NDArray[np.floating[Any] | np.integer[Any]]]):
    """Actions: shape (arms, 7) in [-1, 1]. Observations: a dictionary of all that any operator sees.

    The reward is 1 for the step that completes the task and 0 for every other. An episode terminates with success or
    irrecoverable failure, and is truncated at the task's horizon. `info`: subtasks (name → done), success, failed.
    """

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "render_fps": 20}  # noqa: RUF012

    def __init__(self, task: str, **options: Any) -> None:
        """options: fields of `Options`."""
        chosen = Options(**options)
        self._course = Course(task, chosen)
        self.render_mode = chosen.render_mode
        self.metadata = {**type(self).metadata, "render_fps": chosen.control_hz}
        self.observation_space = observation_space(self._course.task.observations)
        self.action_space = action_space(len(self._course.task.arms))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """`seed` begins the very episode that it begins in a room; without one, the next is drawn."""
        super().reset(seed=seed)
        drawn = int(self.np_random.integers(MAX_SEED)) if seed is None else checked_seed(seed)
        moment = self._course.reset(drawn)
        return moment.observations, moment.info()

    def step(
        self, action: NDArray[np.floating[Any] | np.integer[Any]]
    ) -> tuple[Observations, float, bool, bool, dict[str, Any]]:
        moment = self._course.step(action)
        return moment.observations, moment.reward, moment.terminated, moment.truncated, moment.info()

    def render(self) -> Image | None:
        return self._course.render()

    def close(self) -> None:
        self._course.close()
