"""A task as a PettingZoo environment: one agent for each arm, and each sees what that arm's operator sees."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from mart.protocol.errors import Conflict, InvalidInput
from mart.render import Image
from mart.sim.envs.course import (
    MAX_SEED,
    RENDER_MODES,
    Course,
    Moment,
    Observations,
    Options,
    action_space,
    checked_seed,
    observation_space,
)
from mart.sim.world import ACTION_SIZE

Infos = dict[str, dict[str, object]]


class ArmsEnv(ParallelEnv[str, Observations, NDArray[np.float32]]):  # type: ignore[misc]
    """Agents are the arms, `arm0` and so on. Actions: shape (7,) in [-1, 1]; reward, end and info are everybody's.

    All agents start together and end together: with success, with irrecoverable failure or at the task's horizon.
    """

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "is_parallelizable": True}  # noqa: RUF012

    def __init__(self, task: str, **options: Any) -> None:
        """options: fields of `Options`."""
        chosen = Options(**options)
        self._course = Course(task, chosen)
        facts = self._course.task
        self.render_mode = chosen.render_mode
        self.metadata = {**type(self).metadata, "name": facts.name, "render_fps": chosen.control_hz}
        self.possible_agents = list(facts.arm_names)
        self.agents: list[str] = []
        self._partitions = {arm: observation_space(facts.observations_of(arm)) for arm in facts.arm_names}
        self._actions = {arm: action_space() for arm in facts.arm_names}
        self._joint = observation_space(facts.observations)
        self.state_space = spaces.flatten_space(self._joint)
        self._random, _ = seeding.np_random()
        self._moment: Moment | None = None

    def observation_space(self, agent: str) -> spaces.Dict:
        return self._partitions[agent]

    def action_space(self, agent: str) -> spaces.Box:
        return self._actions[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observations], Infos]:
        """`seed` begins the very episode that it begins in a room; without one, the next is drawn."""
        if seed is not None:
            self._random, _ = seeding.np_random(checked_seed(seed))
        drawn = int(self._random.integers(MAX_SEED)) if seed is None else seed
        moment = self._course.reset(drawn)
        self.agents = list(self.possible_agents)
        return self._seen(moment), self._infos(moment)

    def step(
        self, actions: Mapping[str, NDArray[np.float32]]
    ) -> tuple[dict[str, Observations], dict[str, float], dict[str, bool], dict[str, bool], Infos]:
        """Raises InvalidInput where an arm is missing: the world moves when every arm has been told what to do."""
        moment = self._course.step(self._together(actions))
        if moment.terminated or moment.truncated:
            self.agents = []
        return (
            self._seen(moment),
            dict.fromkeys(self.possible_agents, moment.reward),
            dict.fromkeys(self.possible_agents, moment.terminated),
            dict.fromkeys(self.possible_agents, moment.truncated),
            self._infos(moment),
        )

    def state(self) -> NDArray[np.float64]:
        """The joint observation as one vector, in the order of `gymnasium.spaces.flatten`."""
        if self._moment is None:
            raise Conflict("The state was asked for, but no episode has begun: call reset first.")
        return np.asarray(spaces.flatten(self._joint, self._moment.observations))

    def render(self) -> Image | None:
        return self._course.render()

    def close(self) -> None:
        self._course.close()

    def _together(self, actions: Mapping[str, NDArray[np.float32]]) -> NDArray[np.float64]:
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

    def _seen(self, moment: Moment) -> dict[str, Observations]:
        """Each agent's own arrays, even of what several see: one agent's wrapper must not change another's."""
        self._moment = moment
        return {
            agent: {name: moment.observations[name].copy() for name in space}
            for agent, space in self._partitions.items()
        }

    def _infos(self, moment: Moment) -> Infos:
        return {agent: moment.info() for agent in self.possible_agents}
