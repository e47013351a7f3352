"""Dependence between arms, from episode files: what the data needs and, beside it, what a model uses."""

from __future__ import annotations

import logging
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.episodes.filter import EpisodeFilter
from mart.episodes.folder import list_episodes, readable
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.control_rate import LEARNING_CONTROL_HZ
from mart.protocol.errors import Corrupt, InvalidInput, NotFound
from mart.protocol.tasks import Arm, Task, get_task
from mart.protocol.vocabulary import EpisodeOutcome
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.report.dependence import BINS, MIN_EPISODES, Dependence, ObservedEpisode, dependence

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy

Array = NDArray[np.float64]
_log = logging.getLogger(__name__)

_POLICY_SEED = 0
_SUCCESSFUL = EpisodeFilter(outcomes=(EpisodeOutcome.SUCCESS,))


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
    """Read every task with successful episodes in a folder, as labelled since; dropped ones don't count.

    policies: of each task the one among these is looked at.
    A file that cannot be read is left out, and the log says so. Raises NotFound where there are none, and InvalidInput
    where there are too few.
    """
    listed = readable(list_episodes(folder), [folder])
    by_task: defaultdict[tuple[str, int, tuple[str, ...]], list[LabelledEpisode]] = defaultdict(list)
    for episode in _SUCCESSFUL.apply(listed):
        if episode.task is not None:
            by_task[episode.task, len(episode.arms), episode.arm_kinds].append(episode)
    if not by_task:
        raise NotFound(f"There are no successful episodes in {folder}; `mart collect` records some.")
    for (task, *_), episodes in sorted(by_task.items()):
        if len(episodes) < MIN_EPISODES:  # told before hours may have gone into the other tasks
            raise InvalidInput(
                f"{len(episodes)} successful episodes of {task} are in {folder}; at least {MIN_EPISODES} of a task "
                "tell something about dependence: record more, or move these elsewhere."
            )
    chosen = {(policy.task, len(policy.arms), policy.arm_kinds): policy for policy in policies}
    return [
        _coupling(get_task(*kind), episodes, chosen.get(kind)) for kind, episodes in sorted(by_task.items())
    ]


def _coupling(task: Task, episodes: Sequence[LabelledEpisode], policy: Policy | None) -> Coupling:
    layout = ObservationLayout.of(task)
    read = list(_segments(task, episodes, LEARNING_CONTROL_HZ if policy is None else policy.control_hz))
    if len(read) < MIN_EPISODES:
        raise InvalidInput(
            f"{len(read)} successful episodes of {task.name} can be read; at least {MIN_EPISODES} tell something "
            "about dependence: `mart episodes repair` may save more."
        )
    data = [segment for segments in read for segment in segments]
    observed = [_observed(layout, one) for one in data]
    return Coupling(
        task=task,
        episodes=len(read),
        found={
            arm: dependence(observed, layout.columns_of(arm.name), index)
            for index, arm in enumerate(task.arms)
        },
        reached=_reached(task, data),
        reliance={} if policy is None else _reliance(task, policy, [_before_actions(one) for one in data]),
    )


def _segments(
    task: Task, episodes: Sequence[LabelledEpisode], control_hz: float
) -> Iterator[list[EpisodeData]]:
    """Read the segments of each episode in ticks of `control_hz`, those of a lower rate in their own.

    One that turns out to be damaged is left out, and the log says so.
    """
    for episode in episodes:
        try:
            rate_hz = min(control_hz, episode.control_hz or control_hz)
            yield episode.segments(task, rate_hz, with_integration_states=False)
        except Corrupt as error:
            _log.warning("Left out: %s", error)


def _observed(layout: ObservationLayout, data: EpisodeData) -> ObservedEpisode:
    return ObservedEpisode(layout.vector(data.observations)[:-1].astype(np.float64), data.actions)


def _reached(task: Task, episodes: Sequence[EpisodeData]) -> list[tuple[str, float, bool]]:
    found = []
    for subtask in task.subtasks:
        done = [one.subtasks[subtask.name] for one in episodes if subtask.name in one.subtasks]
        shares = [int(own.argmax()) / max(1, len(own) - 1) for own in done if own.any()]
        if shares:
            found.append((subtask.name, sum(shares) / len(shares), subtask.coordinated))
    return found


def _before_actions(data: EpisodeData) -> dict[str, Array]:
    """Return by name float64[T, *shape], what was seen before each action."""
    return {name: values[:-1] for name, values in data.observations.items()}


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
