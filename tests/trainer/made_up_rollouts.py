"""Made-up episodes, written as the evaluation writes real ones."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import numpy as np

from mart.protocol.messages import Model
from mart.protocol.tasks import Task, get_task
from mart.trainer.evaluate.rollout_episode import RolloutEpisode, write

STARTED_NS = 1_790_000_000_000_000_000
MODEL = Model(sha256="0" * 64, mjb=b"none", mujoco_version="4.0.0")


def recorded(
    task: str, done: Collection[str], outcome: str = "failure", ticks: int = 4, seed: int = 7
) -> RolloutEpisode:
    """Subtasks of `done` are done from the middle of the episode until just before its end."""
    row = get_task(task)
    subtasks = np.zeros((ticks + 1, len(row.subtasks)), bool)
    subtasks[ticks // 2 : ticks] = [subtask.name in done for subtask in row.subtasks]
    return RolloutEpisode(
        task=row,
        control_hz=20.0,
        policy="HBC",
        seed=seed,
        outcome=outcome,
        reason="made up",
        integration_states=[bytes([tick]) * 8 for tick in range(ticks + 1)],
        observations=_observations(row, ticks, seed),
        actions=np.linspace(-1, 1, ticks * len(row.arms) * 7).reshape(ticks, len(row.arms), 7),
        subtasks=subtasks,
    )


def write_footage(folder: Path, number: int, task: str, done: Collection[str], outcome: str) -> Path:
    path = folder / f"evaluation-{number:04}-{task}.mcap"
    write(path, recorded(task, done, outcome, seed=number), MODEL, STARTED_NS)
    return path


def _observations(task: Task, ticks: int, seed: int) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    made = {o.name: random.normal(size=(ticks + 1, *o.shape)) for o in task.observations}
    upright = {f"{arm}/tool_quaternion_in_base": np.eye(4)[[0] * (ticks + 1)] for arm in task.arm_names}
    return made | upright
