"""Dependence between arms, from episode files: what the data needs and, beside it, what a model uses."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mart.episodes.folder import episode_files
from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import State
from mart.protocol.recording import STATE
from mart.protocol.tasks import Arm, Task, get_task
from mart.trainer.data.episode import from_states
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.report.dependence import BINS, MIN_EPISODES, Dependence, ObservedEpisode, dependence

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy

Array = NDArray[np.float64]
_POLICY_SEED = 0


@dataclass(frozen=True)
class Coupling:
    """One task. reached: subtask, the mean share of an episode at which it is first done, whether it is coordinated."""

    task: Task
    episodes: int
    found: Mapping[Arm, Dependence]
    reached: Sequence[tuple[str, float, bool]]
    reliance: Mapping[Arm, Sequence[float]]

    def as_json(self) -> dict[str, object]:
        return {
            "task": self.task.name,
            "episodes": self.episodes,
            "arms": {
                arm.name: {
                    "overall": own.overall,
                    "score": own.score.tolist(),
                    "low": own.low.tolist(),
                    "high": own.high.tolist(),
                }
                for arm, own in self.found.items()
            },
            "reached": [
                {"subtask": name, "share": share, "coordinated": coordinated}
                for name, share, coordinated in self.reached
            ],
            "reliance": {arm.name: list(used) for arm, used in self.reliance.items()},
        }


def read_couplings(folder: Path, policies: Sequence[Policy] = ()) -> list[Coupling]:
    """Of every task with successful episodes in a folder; of a policy for it, if one is among `policies`.

    Raises NotFound where there are none, InvalidInput where there are too few, Corrupt where one cannot be read.
    """
    by_task: defaultdict[tuple[str, int], list[Path]] = defaultdict(list)
    for path in episode_files([folder]):
        record = EpisodeFile.open(path).episode
        if record.outcome == "success" and record.task is not None:
            by_task[record.task, len(record.arms)].append(path)
    if not by_task:
        raise NotFound(f"There are no successful episodes in {folder}; `mart collect` records some.")
    for (task, _), paths in sorted(by_task.items()):
        if len(paths) < MIN_EPISODES:  # told before hours may have gone into the other tasks
            raise InvalidInput(
                f"{len(paths)} successful episodes of {task} are in {folder}; at least {MIN_EPISODES} of a task "
                "tell something about dependence: record more, or move these elsewhere."
            )
    chosen = {(policy.task, len(policy.arms)): policy for policy in policies}
    return [
        _coupling(get_task(*kind), [_states(path) for path in paths], chosen.get(kind))
        for kind, paths in sorted(by_task.items())
    ]


def _coupling(task: Task, episodes: Sequence[Sequence[State]], policy: Policy | None) -> Coupling:
    layout = ObservationLayout.of(task)
    recorded = [_recorded(layout, states) for states in episodes]
    return Coupling(
        task=task,
        episodes=len(episodes),
        found={
            arm: dependence(recorded, layout.columns_of(arm.name), index)
            for index, arm in enumerate(task.arms)
        },
        reached=_reached(task, episodes),
        reliance={}
        if policy is None
        else _reliance(task, policy, [_seen(task, states) for states in episodes]),
    )


def _states(path: Path) -> list[State]:
    return [codec.decode(State, message.payload) for message in EpisodeFile.open(path).messages(STATE)]


def _recorded(layout: ObservationLayout, states: Sequence[State]) -> ObservedEpisode:
    arrays = from_states(layout, states)
    return ObservedEpisode(arrays.observations[:-1].astype(np.float64), arrays.actions.astype(np.float64))


def _reached(task: Task, episodes: Sequence[Sequence[State]]) -> list[tuple[str, float, bool]]:
    found = []
    for index, subtask in enumerate(task.subtasks):
        done = [[state.progress.subtasks[index].done for state in states] for states in episodes]
        shares = [own.index(True) / max(1, len(own) - 1) for own in done if any(own)]
        if shares:
            found.append((subtask.name, sum(shares) / len(shares), subtask.coordinated))
    return found


def _seen(task: Task, states: Sequence[State]) -> dict[str, Array]:
    """By name, float64[ticks, *shape], before each action."""
    values = [{seen.name: seen.value for seen in state.observations} for state in states[:-1]]
    return {
        o.name: np.array([value[o.name] for value in values]).reshape(-1, *o.shape) for o in task.observations
    }


def _reliance(task: Task, policy: Policy, episodes: Sequence[Mapping[str, Array]]) -> dict[Arm, list[float]]:
    """For each arm and part of the episode: how far its action moves when the others' part is another episode's.

    Squared, as a share of how far it would be from the action in that other episode altogether. All episodes are
    stretched to one length, and the policy is led along them: it sees what was recorded, whatever it would have done.
    """
    ticks = max(len(next(iter(episode.values()))) for episode in episodes)
    stretched = {
        name: np.stack([_stretched(episode[name], ticks) for episode in episodes]) for name in episodes[0]
    }
    real = _led(policy, stretched)
    other = np.roll(real, 1, axis=0)
    found = {}
    for index, arm in enumerate(task.arms):
        swapped = {
            o.name: stretched[o.name] if arm.name in o.arms else np.roll(stretched[o.name], 1, axis=0)
            for o in task.observations
        }
        moved = np.square(_led(policy, swapped)[:, :, index] - real[:, :, index]).sum(axis=(0, 2))
        apart = np.square(other[:, :, index] - real[:, :, index]).sum(axis=(0, 2))
        bins = np.arange(ticks) * BINS // ticks
        found[arm] = [float(moved[bins == b].sum() / max(apart[bins == b].sum(), 1e-9)) for b in range(BINS)]
    return found


def _stretched(values: Array, ticks: int) -> Array:
    return values[np.arange(ticks) * len(values) // ticks]


def _led(policy: Policy, observations: Mapping[str, Array]) -> Array:
    """float64[episodes, ticks, arms, 7]"""
    episodes, ticks = next(iter(observations.values())).shape[:2]
    policy.begin(episodes, _POLICY_SEED)
    actions = [
        policy.act({name: observations[name][:, tick] for name in policy.needs}) for tick in range(ticks)
    ]
    return np.stack(actions, axis=1)
