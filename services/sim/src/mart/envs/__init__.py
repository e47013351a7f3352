"""Use every MART task as an environment of your own program; no service needs to run.

One agent for all arms, with Gymnasium's interface:

>>> from mart.envs import make_env, make_parallel_env, task_names
>>> "two_arm_multi_cube_lifting" in task_names()
True
>>> env = make_env("two_arm_multi_cube_lifting")
>>> observation, info = env.reset(seed=7)
>>> observation["cube0/position_in_world"].shape
(3,)
>>> observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
>>> env.action_space.shape, info["subtasks"]
((2, 7), {'lift_cube0': False, 'lift_cube1': False})

One agent for each arm, which sees what that arm's operator sees, with PettingZoo's:

>>> arms = make_parallel_env("three_arm_lift_wiping")
>>> observations, infos = arms.reset(seed=7)
>>> sorted(observations)
['arm0', 'arm1', 'arm2']

A seed begins the very episode that it begins in a room or a rollout. Needs the extra `mart-sim[envs]`; without it,
every function that makes environments raises `mart.protocol.errors.Unavailable`. Actions, observations, reward and ends
are told in docs/how-to-use-the-environments.md.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Literal, TypedDict, Unpack

from mart.protocol.errors import Unavailable
from mart.protocol.tasks import task_names

if TYPE_CHECKING:  # their libraries are an extra, and heavy
    from mart.sim.envs.joint import JointEnv
    from mart.sim.envs.parallel import ArmsEnv

__all__ = ["EnvKeywords", "make_env", "make_parallel_env", "register_envs", "task_names"]


class EnvKeywords(TypedDict, total=False):
    """Choose how an environment is built; what is left out has the default told here."""

    control_hz: float
    """Steps a second of simulated time, 5 to 100; default 20."""
    arms: int | None
    """How many arms, where the task can have several numbers; default: the task's own."""
    arm_kinds: Mapping[str, str]
    """By arm: its kind, of those that are no Pandas, such as {"arm1": "ur5e"}; `mart arms list` names them."""
    render_mode: Literal["rgb_array"] | None
    """What `render` gives: pictures, or nothing, which is the default."""
    viewpoint: str
    """Which camera `render` shows: an arm's name, or "front", the default."""
    width_px: int
    """Width of a picture; default 640."""
    height_px: int
    """Height of a picture; default 480."""
    detail: Literal["hull", "detailed"]
    """How finely the arms are drawn: "hull", the default, or "detailed" for machines with a GPU."""


def make_env(task: str, **keywords: Unpack[EnvKeywords]) -> JointEnv:
    """Make a task's Gymnasium environment: one agent that sees everything and moves every arm.

    task: its name, or a task file of your own. Actions have the shape (arms, 7) in [-1, 1]; observations are float64
    arrays by name. Raises NotFound for an unknown task, viewpoint or render mode, InvalidInput for a rate or arms that
    cannot be, Unavailable without the extra.

    >>> with contextlib.closing(make_env("two_arm_table_assembly", control_hz=30.0)) as env:
    ...     env.action_space.shape
    (2, 7)
    """
    with _needs_extra():
        from mart.sim.envs.joint import JointEnv
    return JointEnv(task, **keywords)


def make_parallel_env(task: str, **keywords: Unpack[EnvKeywords]) -> ArmsEnv:
    """Make a task's PettingZoo environment: one agent for each arm, `arm0` and so on.

    Each agent acts with the shape (7,) in [-1, 1] and sees what its arm's operator sees. Raises as `make_env`.

    >>> with contextlib.closing(make_parallel_env("two_arm_multi_cube_lifting", arms=4)) as env:
    ...     env.possible_agents
    ['arm0', 'arm1', 'arm2', 'arm3']
    """
    with _needs_extra():
        from mart.sim.envs.parallel import ArmsEnv
    return ArmsEnv(task, **keywords)


def register_envs() -> tuple[str, ...]:
    """Register every task with Gymnasium and return the ids, for code that makes environments by id.

    Raises Unavailable without the extra.

    >>> "mart/TwoArmMultiCubeLifting-v0" in register_envs()
    True
    """
    with _needs_extra():
        from mart.sim.envs.registration import register_envs
    return register_envs()


@contextlib.contextmanager
def _needs_extra() -> Iterator[None]:
    try:
        yield
    except ImportError as error:  # of gymnasium, pettingzoo, PyOpenGL or the system's EGL
        raise Unavailable(
            f'Environments need what this installation lacks ({error}): pip install "mart-sim[envs]", and libegl1.'
        ) from error
