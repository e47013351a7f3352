"""Tell of one episode what its file says and what people have said since: how it ended is decided here alone."""

from __future__ import annotations

from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field

from mart.episodes.labels import EpisodeLabels
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt, MartError
from mart.protocol.recording import OperatorsRecord, Shift
from mart.protocol.vocabulary import EpisodeOutcome, Verdict


class LabelledEpisode(BaseModel):
    """Describe one episode file by its metadata, overlaid with its labels.

    path: below the folder of its labels, as labels name it. file_path: where it lies, as it was asked for.
    outcome, verdict: as labelled, else as recorded. operators: who drove each arm (`human Ana | tick 57: hold`).
    ended_by: task, time, operator, absence or room; None where nobody wrote it down. subtasks_done: in the last state.
    missing_commands: how many commands the states name and the file lacks; None where nobody counted.
    error: why the file cannot be used; what else it says is not known then. dropped: nobody shall learn from it.
    """

    model_config = ConfigDict(frozen=True)

    path: str
    size_bytes: int
    file_path: Path = Field(Path(), exclude=True)
    room: str = ""
    number: int = 0
    task: str | None = None
    control_hz: float | None = None
    arms: tuple[str, ...] = ()
    outcome: str = EpisodeOutcome.UNSPECIFIED.value
    verdict: str = Verdict.UNVERIFIED.value
    reason: str = ""
    ended_by: str | None = None
    ended_by_name: str | None = None
    ended_by_arm: str | None = None
    subtasks_done: int | None = None
    subtasks: int | None = None
    ticks: int = 0
    simulated_s: float = 0.0
    seed: int | None = None
    mode: str | None = None
    skill: str | None = None
    time_limit_s: float | None = None
    real_time_factor: float | None = None
    missing_ticks: int = 0
    missing_commands: int | None = None
    waited_s: float = 0.0
    started_ns: int = 0
    complete: bool = False
    repaired: bool = False
    interrupted: bool = False
    operators: dict[str, str] = {}
    error: str | None = None
    note: str | None = None
    dropped: bool = False
    datasets: tuple[str, ...] = ()  # that it is part of

    @property
    def verified(self) -> bool:
        """Whether every recorded tick follows from the one before, bit for bit."""
        return self.verdict == Verdict.VERIFIED

    @property
    def shifts(self) -> tuple[Shift, ...]:
        """Who drove, arm after arm, with changes."""
        by_arm = OperatorsRecord.from_strings(self.operators).shifts
        return tuple(shift for shifts in by_arm.values() for shift in shifts)

    def open(self) -> EpisodeFile:
        """Open the file. Raises Corrupt where it cannot be used and NotFound where it is gone."""
        if self.error is not None:
            raise Corrupt(self.error)
        return EpisodeFile.open(self.file_path)

    def with_labels(self, said: EpisodeLabels | None) -> LabelledEpisode:
        """Return this episode with what was said about it; None where nothing was."""
        if said is None:
            return self
        changes = {
            "outcome": said.outcome or self.outcome,
            "verdict": said.verdict or self.verdict,
            "note": said.note,
            "dropped": said.dropped,
            "datasets": tuple(sorted(said.datasets)),
        }
        return self.model_copy(update=changes)


def describe(file_path: Path, path: str) -> LabelledEpisode:
    """Describe one file by its metadata alone; of one that cannot be read, `error` says why.

    path: below the folder of its labels. Raises FileNotFoundError where there is no file.
    """
    found = LabelledEpisode(path=path, file_path=file_path, size_bytes=file_path.stat().st_size)
    try:
        file = EpisodeFile.open(file_path)
        episode, cadence, operators = file.episode, file.cadence, file.operators
        verdict = file.verification.verdict.value
    except MartError as error:
        return found.model_copy(update={"error": str(error)})
    known = {name: value for name, value in episode if name in LabelledEpisode.model_fields}
    return found.model_copy(
        update=known
        | {"verdict": verdict, "operators": operators.to_strings()}
        | {"real_time_factor": cadence.real_time_factor}
        | {"missing_ticks": cadence.missing_ticks, "missing_commands": cadence.missing_commands}
        | {"waited_s": cadence.waited_s}
        | {"simulated_s": episode.ticks / episode.control_hz if episode.control_hz else 0.0}
    )


def require_readable(episodes: list[LabelledEpisode]) -> None:
    """Raise Corrupt, with the first one's reason, where an episode cannot be read."""
    for episode in episodes:
        if episode.error is not None:
            raise Corrupt(episode.error)
