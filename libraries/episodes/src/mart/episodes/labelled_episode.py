"""Tell of one episode what its file says and what people have said since: how it ended is decided here alone."""

from __future__ import annotations

import logging
import os
from functools import lru_cache
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field

from mart.episodes.arrays import EpisodeData
from mart.episodes.editing import edited
from mart.episodes.edits import EpisodeEdits
from mart.episodes.idle import idle_ranges
from mart.episodes.labels import EpisodeLabels
from mart.episodes.reader import EpisodeFile
from mart.episodes.scan import ForeignFile
from mart.protocol.control_rate import same_control_hz
from mart.protocol.errors import Corrupt, InvalidInput, MartError, NotFound
from mart.protocol.recording import OperatorsRecord, Shift, VerificationRecord
from mart.protocol.tasks import Task, get_task, is_in_catalogue
from mart.protocol.vocabulary import EpisodeOutcome, Verdict

_log = logging.getLogger(__name__)


class LabelledEpisode(BaseModel):
    """Describe one episode file by its metadata, overlaid with its labels.

    path: below the folder of its labels, as labels name it. file_path: where it lies, as it was asked for.
    outcome, verdict: as labelled, else as recorded. outcome_by: who labelled it so, where that is known.
    operators: who drove each arm (`human Ana | tick 57: hold`).
    verification_pending: it is unverified because nobody could step it again yet; the recorder tries until it can.
    ended_by: task, time, operator, absence or room; None where nobody wrote it down. subtasks_done: in the last state.
    missing_commands: how many commands the states name and the file lacks; None where nobody counted.
    error: why the file cannot be used; what else it says is not known then. foreign: because it is none of MART's.
    dropped: nobody shall learn from it. edits: what of it is left out, split or told otherwise.
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
    arm_kinds: tuple[str, ...] = ()
    world: str | None = None
    measured_arms: tuple[str, ...] | None = None
    outcome: str = EpisodeOutcome.UNSPECIFIED.value
    verdict: str = Verdict.UNVERIFIED.value
    verification_pending: bool = False
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
    foreign: bool = False
    outcome_by: str | None = None
    note: str | None = None
    dropped: bool = False
    datasets: tuple[str, ...] = ()  # that it is part of
    edits: EpisodeEdits = EpisodeEdits()

    @property
    def verified(self) -> bool:
        """Whether every recorded tick follows from the one before, bit for bit."""
        return self.verdict == Verdict.VERIFIED

    @property
    def shifts(self) -> tuple[Shift, ...]:
        """Who drove, arm after arm, with changes."""
        return _shifts_of(tuple(self.operators.items()))

    def open(self) -> EpisodeFile:
        """Open the file. Raises Corrupt where it cannot be used and NotFound where it is gone."""
        if self.error is not None:
            raise Corrupt(self.error)
        return EpisodeFile.open(self.file_path)

    def segments(
        self,
        task: Task | None = None,
        control_hz: float | None = None,
        skip_idle_s: float | None = None,
        *,
        with_integration_states: bool = True,
    ) -> list[EpisodeData]:
        """Read the episode into arrays as people have edited it: a segment for each motion that is left, in order.

        task, control_hz, with_integration_states: as for `EpisodeFile.arrays`.
        skip_idle_s: leave out, too, every stretch of at least so many seconds in which no arm moves; None leaves out
        what people did alone.
        Raises what `EpisodeFile.arrays` raises, and InvalidInput, naming it, where nothing is left of it.
        """
        file = self.open()
        at_its_own_rate = control_hz is None or same_control_hz(self.control_hz or 0.0, control_hz)
        is_whole = not self.edits and skip_idle_s is None and at_its_own_rate
        whole = file.arrays(task, with_integration_states=with_integration_states and is_whole)
        skips = () if skip_idle_s is None else idle_ranges(whole, skip_idle_s)
        found = edited(whole, self.edits.with_skips(skips))
        if not found:
            raise InvalidInput(
                f"{self.file_path} has nothing left: all of it was cut out, or is idle; drop it."
            )
        segments = [file.resampled(segment, control_hz, task) for segment in found]
        return (
            file.with_integration_states(segments) if with_integration_states and not is_whole else segments
        )

    def recorded_task(self) -> Task:
        """Return the task with the arms that were recorded; that of somebody's own task as the file says it.

        Raises NotFound for an unknown one, InvalidInput for arms it cannot have, Corrupt where the file is damaged.
        """
        if is_in_catalogue(self.task or ""):
            return get_task(self.task or "", len(self.arms), self.arm_kinds)
        return self.open().task()

    def with_labels(self, said: EpisodeLabels | None) -> LabelledEpisode:
        """Return this episode with what was said about it; None where nothing was."""
        if said is None:
            return self
        changes = {
            "outcome": said.outcome or self.outcome,
            "outcome_by": said.outcome_by or None,
            "verdict": said.verdict or self.verdict,
            "verification_pending": self.verification_pending and said.verdict is None,
            "note": said.note,
            "dropped": said.dropped,
            "datasets": tuple(sorted(said.datasets)),
            "edits": said.edits,
        }
        return self.model_copy(update=changes)


@lru_cache(maxsize=16384)  # asked of every episode of a folder with every listing
def _shifts_of(operators: tuple[tuple[str, str], ...]) -> tuple[Shift, ...]:
    by_arm = OperatorsRecord.from_strings(dict(operators)).shifts
    return tuple(shift for shifts in by_arm.values() for shift in shifts)


def describe(file_path: Path, path: str) -> LabelledEpisode:
    """Describe one file by its metadata alone; of one that cannot be read, `error` says why, whatever it is.

    path: below the folder of its labels. Raises FileNotFoundError where nothing is.
    """
    found = LabelledEpisode(path=as_utf8(path), file_path=file_path, size_bytes=_size_of(file_path))
    try:
        return found.model_copy(update=_facts(EpisodeFile.open(file_path)))
    except MartError as error:
        why, foreign = str(error), isinstance(error, ForeignFile | NotFound)
    except Exception as error:  # noqa: BLE001 - logged whole; one file never keeps a folder from being listed
        _log.exception("%s could not be described", as_utf8(str(file_path)))
        foreign = False
        why = f"{file_path} cannot be read: {error}. That it is not told better is a fault of MART's."
    return found.model_copy(update={"error": as_utf8(why), "foreign": foreign})


def _facts(file: EpisodeFile) -> dict[str, object]:
    episode, cadence = file.episode, file.cadence
    known = {name: value for name, value in episode if name in LabelledEpisode.model_fields}
    verification = file.verification
    return (
        known
        | {"verdict": verification.verdict.value, "verification_pending": is_pending(verification)}
        | {"operators": file.operators.to_strings()}
        | {"real_time_factor": cadence.real_time_factor}
        | {"missing_ticks": cadence.missing_ticks, "missing_commands": cadence.missing_commands}
        | {"waited_s": cadence.waited_s}
        | {"simulated_s": episode.ticks / episode.control_hz if episode.control_hz else 0.0}
    )


def is_pending(verification: VerificationRecord) -> bool:
    """Whether a verdict is still to be had; files of versions that did not say so are tried once more."""
    return verification.verdict is Verdict.UNVERIFIED and verification.pending is not False


def _size_of(path: Path) -> int:
    """Return a file's size; 0 of what is there and has none that can be told, such as a link that leads nowhere."""
    try:
        return path.stat().st_size
    except OSError:
        if not os.path.lexists(path):
            raise
        return 0


def as_utf8(text: str) -> str:
    """Return text that can be written; bytes of a file's name that are no UTF-8 become a sign for it."""
    return text.encode(errors="surrogateescape").decode(errors="replace")
