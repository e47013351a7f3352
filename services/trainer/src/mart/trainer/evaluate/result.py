"""What evaluations say, as lines of `evaluations.jsonl`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from mart.protocol.errors import Corrupt
from mart.protocol.tasks import get_task
from mart.trainer.evaluate.seeds import Purpose
from mart.trainer.evaluate.statistics import Rate

Outcome = Literal["success", "failure", "time"]  # time: it was up
MAX_ROLLOUTS = 16
NOT_HELD = "success"  # where an episode failed that had done every subtask


class Played(BaseModel):
    """One episode. time_s: simulated, until it ended. done: subtasks that were done at any time."""

    model_config = ConfigDict(frozen=True)

    seed: int
    outcome: Outcome
    time_s: float
    done: tuple[str, ...]
    rollout: str = ""  # its file below the run's `rollouts`, where it was kept


class Evaluation(BaseModel):
    """Episodes of one checkpoint, all in worlds of one stream of seeds."""

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
    played: tuple[Played, ...]

    @property
    def rate(self) -> Rate:
        return Rate(sum(played.outcome == "success" for played in self.played), len(self.played))

    @property
    def mean_success_time_s(self) -> float | None:
        """None without a success."""
        times = [played.time_s for played in self.played if played.outcome == "success"]
        return sum(times) / len(times) if times else None

    @property
    def done(self) -> dict[str, int]:
        """Subtask → in how many episodes it was done, in the catalogue's order."""
        return {name: sum(name in played.done for played in self.played) for name in self._subtasks}

    @property
    def failures(self) -> dict[str, int]:
        """The first subtask that was missing → in how many episodes; `success` where all were done but not held."""
        counted = Counter(self._missing(played) for played in self.played if played.outcome != "success")
        return {name: counted[name] for name in (*self._subtasks, NOT_HELD) if counted[name]}

    @property
    def _subtasks(self) -> tuple[str, ...]:
        return tuple(subtask.name for subtask in get_task(self.task).subtasks)

    def _missing(self, played: Played) -> str:
        return next((name for name in self._subtasks if name not in played.done), NOT_HELD)


def append(path: Path, evaluations: Iterable[Evaluation]) -> None:
    """One line each, after what is there; on the disk of its own accord, for what is lost is evaluated anew."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("ab+") as file:
        torn = file.tell() > 0 and _last_byte(path) != b"\n"
        lines = "".join(evaluation.model_dump_json() + "\n" for evaluation in evaluations)
        file.write((("\n" if torn else "") + lines).encode())


def read(path: Path) -> list[Evaluation]:
    """Every whole line; one that a kill has torn at the end of a write is left out. Raises Corrupt for other damage."""
    if not path.is_file():
        return []
    lines = path.read_bytes().split(b"\n")
    return [found for line in filter(None, lines) if (found := _parse(line, path)) is not None]


def best(evaluations: Sequence[Evaluation]) -> Evaluation:
    """Of at least one, by success rate; of equals the one that was trained longest."""
    return max(evaluations, key=lambda evaluation: (evaluation.rate.value, evaluation.updates))


def _parse(line: bytes, path: Path) -> Evaluation | None:
    if not line.endswith(b"}"):
        return None
    try:
        return Evaluation.model_validate_json(line)
    except ValidationError as error:
        raise Corrupt(f"{path} holds a line that is no evaluation; remove it and evaluate again.") from error


def _last_byte(path: Path) -> bytes:
    with path.open("rb") as file:
        file.seek(-1, 2)
        return file.read(1)
