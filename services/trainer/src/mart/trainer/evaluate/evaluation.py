"""What evaluations say, as lines of `evaluations.jsonl`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from enum import StrEnum
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from mart.protocol.errors import Corrupt
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import EpisodeOutcome
from mart.runtime.json_lines import append_json_line, read_json_lines
from mart.trainer.evaluate.statistics import Rate
from mart.trainer.evaluate.world_seeds import Purpose

MAX_ROLLOUTS = 16
NOT_HELD = EpisodeOutcome.SUCCESS.value  # where an episode failed that had done every subtask


class RolloutOutcome(StrEnum):
    """Name how an episode of an evaluation ended; `time`: it was up."""

    SUCCESS = EpisodeOutcome.SUCCESS.value
    FAILURE = EpisodeOutcome.FAILURE.value
    TIME = "time"


class EpisodeResult(BaseModel):
    """How one episode of an evaluation went. time_s: simulated, until it ended. done: subtasks done at any time."""

    model_config = ConfigDict(frozen=True)

    seed: int
    outcome: RolloutOutcome
    time_s: float
    done: tuple[str, ...]
    rollout: str = ""  # its file below the run's `rollouts`, where it was kept

    @property
    def succeeded(self) -> bool:
        """Whether the episode ended with success."""
        return self.outcome is RolloutOutcome.SUCCESS


class Evaluation(BaseModel):
    """What one checkpoint did in the worlds of one stream of seeds: an episode in each."""

    model_config = ConfigDict(frozen=True)

    at_ns: int
    model: str
    task: str
    seed: int  # of the training
    updates: int
    checkpoint: str  # below the run's folder; as given where it is of no run
    purpose: Purpose
    world_seed: int
    time_limit_s: float
    played: tuple[EpisodeResult, ...]

    @property
    def rate(self) -> Rate:
        """How many of the episodes succeeded."""
        return Rate(sum(result.succeeded for result in self.played), len(self.played))

    @property
    def mean_success_time_s(self) -> float | None:
        """Mean simulated time of the successful episodes; None without one."""
        times = [result.time_s for result in self.played if result.succeeded]
        return sum(times) / len(times) if times else None

    @property
    def done(self) -> dict[str, int]:
        """Subtask → in how many episodes it was done, in the catalogue's order."""
        return {name: sum(name in result.done for result in self.played) for name in self._subtasks}

    @property
    def failures(self) -> dict[str, int]:
        """First subtask that was missing → in how many episodes; `success` where all were done but not held."""
        counted = Counter(self._missing(result) for result in self.played if not result.succeeded)
        return {name: counted[name] for name in (*self._subtasks, NOT_HELD) if counted[name]}

    @property
    def _subtasks(self) -> tuple[str, ...]:
        return tuple(subtask.name for subtask in get_task(self.task).subtasks)

    def _missing(self, result: EpisodeResult) -> str:
        return next((name for name in self._subtasks if name not in result.done), NOT_HELD)


def append_evaluations(path: Path, evaluations: Iterable[Evaluation]) -> None:
    """Append each evaluation to the file as one line; a missing folder is made, a torn line before them is ended."""
    for evaluation in evaluations:
        append_json_line(path, evaluation.model_dump(mode="json"))


def read_evaluations(path: Path) -> list[Evaluation]:
    """Return every evaluation of the file; a line that a kill has torn is left out. Raises Corrupt for other damage."""
    return [_evaluation(row, path) for _, row in read_json_lines(path) if row is not None]


def best_evaluation(evaluations: Sequence[Evaluation]) -> Evaluation:
    """Return the one of at least one with the highest success rate; of equals the one that was trained longest."""
    return max(evaluations, key=lambda evaluation: (evaluation.rate.value, evaluation.updates))


def _evaluation(row: dict[str, object], path: Path) -> Evaluation:
    try:
        return Evaluation.model_validate(row)
    except ValidationError as error:
        raise Corrupt(f"{path} holds a line that is no evaluation; remove it and evaluate again.") from error
