"""Run episodes of one task and draw them: what both kinds of environment share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.control_rate import DEFAULT_CONTROL_HZ
from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.protocol.pose import Pose
from mart.protocol.tasks import SHARED_VIEWPOINT, Observation, Task, arm_kinds_of, task_called
from mart.render import Image, Renderer
from mart.sim.scene.meshes import Detail
from mart.sim.world import Diverged, World

Observations = dict[str, NDArray[np.float64]]
Action = NDArray[np.floating[Any] | np.integer[Any]]  # shape (arms, 7), or (7,) of one arm

RENDER_MODES = ("rgb_array",)
MAX_SEED = 2**63
_BOUND = 10.0  # metres, radians, shares: nothing that is still in the room comes near it


@dataclass(frozen=True)
class EnvOptions:
    """Choose how a task's environment is built; the fields are the keywords of both kinds.

    `arms`: how many, where the task can have several numbers. `arm_kinds`: by arm, of those that are no Pandas.
    `viewpoint`: which camera `render` shows, an arm's name or "front". `detail`: "hull", or "detailed" for machines
    with a GPU.
    """

    render_mode: str | None = None
    control_hz: float = DEFAULT_CONTROL_HZ
    arms: int | None = None
    arm_kinds: Mapping[str, str] = field(default_factory=dict)
    viewpoint: str = SHARED_VIEWPOINT
    width_px: int = 640
    height_px: int = 480
    detail: Detail = "hull"

    def __post_init__(self) -> None:
        if self.render_mode not in (None, *RENDER_MODES):
            raise NotFound.named("render mode", str(self.render_mode), RENDER_MODES)


@dataclass(frozen=True)
class StepResult:
    """Tell how the world is between two steps; `failed` says why the task can no longer succeed, "" while it can."""

    observations: Observations
    subtasks: dict[str, bool]
    success: bool
    failed: str
    truncated: bool

    @property
    def terminated(self) -> bool:
        """Whether the episode is over by success, or by a failure that nothing can mend."""
        return self.success or bool(self.failed)

    @property
    def reward(self) -> float:
        """Return 1 for the step that completes the task, 0 for every other."""
        return float(self.success)

    def info(self) -> dict[str, object]:
        """Return a new dictionary at each call (whoever holds one may change it): subtasks, success, failed."""
        return {"subtasks": dict(self.subtasks), "success": self.success, "failed": self.failed}


class EpisodeRunner:
    """Run one world of a task, one episode after the other, and draw it."""

    def __init__(self, task: str, options: EnvOptions) -> None:
        """Build the world of a task, by its name or its task file.

        Raises NotFound for an unknown task or viewpoint, InvalidInput for what it cannot have.
        """
        name = task_called(task)
        kinds = arm_kinds_of(name, options.arms, options.arm_kinds)
        self._world = World.build(name, options.control_hz, options.arms, options.detail, kinds)
        self._options = options
        self._horizon_ticks = self.task.horizon_at(options.control_hz)
        self._ticks: int | None = None  # None: the episode is over, or none has begun
        self._last: Observations = {}
        self._renderer: Renderer | None = None
        if options.viewpoint not in self.task.viewpoints:
            raise NotFound.named("viewpoint", options.viewpoint, self.task.viewpoints)

    @property
    def task(self) -> Task:
        """The catalogue's row of the task."""
        return self._world.task

    @property
    def control_hz(self) -> float:
        """Steps a second of simulated time."""
        return self._options.control_hz

    def action_for(self, arm: str, target_tool_in_base: Pose, gripper: float) -> NDArray[np.float64]:
        """Return what `World.action_for` returns: the action, shape (7,), that goes towards an absolute target."""
        return self._world.action_for(arm, target_tool_in_base, gripper)

    def reset(self, seed: int) -> StepResult:
        """Begin the episode that rooms and rollouts begin with this seed."""
        self._world.reset(seed)
        self._ticks = 0
        return self._result()

    def step(self, actions: ArrayLike) -> StepResult:
        """Advance one control period; actions: shape (arms, 7), in [-1, 1], see `World`.

        Raises InvalidInput for actions that cannot be, Conflict where the episode is over.
        """
        if self._ticks is None:
            raise Conflict("A step was asked for, but no episode is running: call reset first.")
        try:
            self._world.step(actions)
        except Diverged as error:
            self._ticks = None
            return StepResult(
                _copied(self._last), dict.fromkeys(self._subtasks(), False), False, str(error), False
            )
        self._ticks += 1
        result = self._result()
        if result.terminated or result.truncated:
            self._ticks = None
        return result

    def render(self) -> Image | None:
        """Draw the chosen viewpoint: uint8, shape (height, width, 3); None without a render mode."""
        if self._options.render_mode is None:
            return None
        if self._renderer is None:
            options = self._options
            self._renderer = Renderer(
                self._world.model, options.viewpoint, options.width_px, options.height_px
            )
        return self._renderer.draw(self._world.integration_state())

    def close(self) -> None:
        """Let the renderer go; the world stays usable."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _result(self) -> StepResult:
        progress = self._world.progress()
        assert self._ticks is not None
        self._last = self._world.observations()
        return StepResult(
            observations=_copied(self._last),
            subtasks={name: bool(done) for name, done in progress.subtasks.items()},
            success=bool(progress.success),
            failed=progress.failed or "",
            truncated=self._ticks >= self._horizon_ticks,
        )

    def _subtasks(self) -> Iterable[str]:
        return (subtask.name for subtask in self.task.subtasks)


def _copied(observations: Observations) -> Observations:
    """Copy observations: whoever is given them keeps them, while the world's own follow it."""
    return {name: value.copy() for name, value in observations.items()}


def observation_space(observations: Iterable[Observation]) -> spaces.Dict:
    """Return the space of these observations: float64 arrays by the catalogue's names."""
    return spaces.Dict({one.name: spaces.Box(-_BOUND, _BOUND, one.shape, np.float64) for one in observations})


def action_space(*leading: int) -> spaces.Box:
    """Return the space [-1, 1] of float32 actions, shape (*leading, 7)."""
    return spaces.Box(-1.0, 1.0, (*leading, ACTION_SIZE), np.float32)


def checked_seed(seed: int) -> int:
    """Return the seed; raises InvalidInput where it is not from 0 to 2^63 - 1."""
    if not 0 <= seed < MAX_SEED:
        raise InvalidInput(f"The seed {seed} was given; it must be from 0 to 2^63 - 1.")
    return seed
