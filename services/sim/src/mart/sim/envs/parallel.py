"""Offer a task as a PettingZoo environment: one agent for each arm, which sees what that arm's operator sees."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import Conflict, InvalidInput
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
    StepResult,
    action_space,
    checked_seed,
    observation_space,
)

Infos = dict[str, dict[str, object]]


class ArmsEnv(ParallelEnv[str, Observations, Action]):  # type: ignore[misc]
    """Step a task as one agent for each arm (`arm0`, …): actions of shape (7,) in [-1, 1]; all share reward and end.

    All agents start together and end together: with success, with irrecoverable failure or at the task's horizon.
    """

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "is_parallelizable": True}  # noqa: RUF012

    def __init__(self, task: str, **options: Any) -> None:
        """Build the environment of a task; the options are the fields of `EnvOptions`. Raises as `EpisodeRunner`."""
        chosen = EnvOptions(**options)
        self._runner = EpisodeRunner(task, chosen)
        facts = self.task
        self.render_mode = chosen.render_mode
        self.metadata = {**type(self).metadata, "name": facts.name, "render_fps": chosen.control_hz}
        self.possible_agents = list(facts.arm_names)
        self.agents: list[str] = []
        self._partitions = {arm: observation_space(facts.observations_of(arm)) for arm in facts.arm_names}
        self._actions = {arm: action_space() for arm in facts.arm_names}
        self._joint = observation_space(facts.observations)
        self.state_space = spaces.flatten_space(self._joint)
        self._random, _ = seeding.np_random()
        self._result: StepResult | None = None

    @property
    def task(self) -> Task:
        """The task as data: arms with their bases' poses in the world, subtasks, observations, limits, horizon."""
        return self._runner.task

    def action_for(self, arm: str, target_tool_in_base: Pose, gripper: float) -> NDArray[np.float64]:
        """Return the action, shape (7,), that takes an arm's tool towards a pose in the arm's base frame.

        It goes as far as one step and the workspace allow. gripper: 0 open … 1 closed. Raises NotFound for no such arm.
        """
        return self._runner.action_for(arm, target_tool_in_base, gripper)

    def observation_space(self, agent: str) -> spaces.Dict:
        """Return the space of what this arm's operator sees."""
        return self._partitions[agent]

    def action_space(self, agent: str) -> spaces.Box:
        """Return the space of this arm's actions, shape (7,)."""
        return self._actions[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observations], Infos]:
        """Begin the very episode that `seed` begins in a room; without one, the next seed is drawn."""
        if seed is not None:
            self._random, _ = seeding.np_random(checked_seed(seed))
        drawn = int(self._random.integers(MAX_SEED)) if seed is None else seed
        result = self._runner.reset(drawn)
        self.agents = list(self.possible_agents)
        return self._seen(result), self._infos(result)

    def step(
        self, actions: Mapping[str, Action]
    ) -> tuple[dict[str, Observations], dict[str, float], dict[str, bool], dict[str, bool], Infos]:
        """Advance one control period. Raises InvalidInput where an arm has no action: the world waits for every arm."""
        result = self._runner.step(self._together(actions))
        if result.terminated or result.truncated:
            self.agents = []
        return (
            self._seen(result),
            dict.fromkeys(self.possible_agents, result.reward),
            dict.fromkeys(self.possible_agents, result.terminated),
            dict.fromkeys(self.possible_agents, result.truncated),
            self._infos(result),
        )

    def state(self) -> NDArray[np.float64]:
        """Return the joint observation as one vector, in the order of `gymnasium.spaces.flatten`."""
        if self._result is None:
            raise Conflict("The state was asked for, but no episode has begun: call reset first.")
        return np.asarray(spaces.flatten(self._joint, self._result.observations))

    def render(self) -> Image | None:
        """Draw the chosen viewpoint: uint8, shape (height, width, 3); None without a render mode."""
        return self._runner.render()

    def close(self) -> None:
        """Let the renderer go."""
        self._runner.close()

    def _together(self, actions: Mapping[str, Action]) -> NDArray[np.float64]:
        if set(actions) != set(self.possible_agents):
            raise InvalidInput(
                f"Actions for {', '.join(sorted(actions)) or 'nobody'} were given; every arm needs one: "
                f"{', '.join(self.possible_agents)}."
            )
        rows = [np.asarray(actions[arm], dtype=np.float64) for arm in self.possible_agents]
        for arm, row in zip(self.possible_agents, rows, strict=True):
            if row.shape != (ACTION_SIZE,):
                raise InvalidInput(
                    f"An action of shape {row.shape} was given for {arm}; ({ACTION_SIZE},) is needed."
                )
        return np.array(rows)

    def _seen(self, result: StepResult) -> dict[str, Observations]:
        """Give each agent arrays of its own, even of what several see: one's wrapper must not change another's."""
        self._result = result
        return {
            agent: {name: result.observations[name].copy() for name in space}
            for agent, space in self._partitions.items()
        }

    def _infos(self, result: StepResult) -> Infos:
        return {agent: result.info() for agent in self.possible_agents}
