"""Say in an imported episode's metadata what it is and where it is from. Pure."""

from __future__ import annotations

import re
from collections.abc import Mapping
from datetime import UTC, datetime
from itertools import groupby

from mart.protocol.errors import Corrupt
from mart.protocol.messages import operator_word
from mart.protocol.recording import EpisodeRecord, OperatorsRecord, RoomRecord, Shift
from mart.protocol.tasks import Task
from mart.protocol.vocabulary import EpisodeOutcome
from mart.recorder.importing.episode_states import StateRows
from mart.recorder.importing.foreign_episode import ForeignEpisode

ORIGIN = "mart.origin"
MODE = "imported"
_UNKNOWN = "unknown"  # who drove, where nobody wrote it down
_LONGEST_ROOM = 40


def room_of(source: str) -> str:
    """Return the room that the episodes of a file or folder of this name are said to be of."""
    stem = re.sub(r"[^a-z0-9_-]+", "-", source.partition(".")[0].lower()).strip("-_")[:_LONGEST_ROOM]
    return stem or "import"


def origin_record(episode: ForeignEpisode, file_format: str, now_ns: int) -> dict[str, str]:
    """Return the record `mart.origin`: of which file, with which digest, and what of it is not here."""
    record = {
        "format": file_format,
        "file": episode.source_file,
        "sha256": episode.source_sha256,
        "episode": episode.name,
        "imported_at": datetime.fromtimestamp(now_ns / 1e9, UTC).isoformat(timespec="seconds"),
    }
    if episode.instruction:
        record["instruction"] = episode.instruction[:1000]
    if episode.left_out:
        record["left_out"] = " ".join(episode.left_out)[:4000]
    return record


def episode_record(
    episode: ForeignEpisode, rows: StateRows, task: Task | None, control_hz: float | None, room: str
) -> EpisodeRecord:
    """Return what the episode is. Of MART's own export it is what was recorded, with what is here now.

    Raises Corrupt where the records that the export carries are none.
    """
    recorded = _recorded(episode)
    found = {
        "room": room,
        "number": episode.number + 1,
        "task": task.name if task else None,
        "control_hz": control_hz,
        "arms": rows.arms,
        "arm_kinds": task.arm_kinds if task else (),
        "started_ns": int(rows.sent_ns[0]),
        "ended_ns": int(rows.sent_ns[-1]),
        "ticks": len(rows) - 1,
        "first_tick": int(rows.ticks[0]),
        "last_tick": int(rows.ticks[-1]),
        "outcome": _outcome(episode, rows, task),
        "complete": True,
        "repaired": False,
        "subtasks_done": sum(bool(done[-1]) for done in rows.subtasks.values()) if task else None,
        "subtasks": len(task.subtasks) if task else None,
    }
    if recorded is not None:
        return recorded.model_copy(update=found)
    return EpisodeRecord(**found, reason=f"imported from {episode.source_file}", mode=MODE, interrupted=False)


def room_record(
    episode: ForeignEpisode, task: Task | None, control_hz: float | None, room: str
) -> RoomRecord:
    """Return of what room it is. Its model is named where it is there; its rate only where ticks follow at it."""
    found = {"room": room, "task": task.name if task else None, "control_hz": control_hz}
    strings = {} if episode.origin is None else episode.origin.records.get(RoomRecord.NAME, {})
    if not strings:
        return RoomRecord(**found, arm_kinds=task.arm_kinds if task else ())
    return RoomRecord.from_strings(strings).model_copy(update=found)


def is_at_another_rate(episode: ForeignEpisode, control_hz: float | None) -> bool:
    """Tell whether an export of ours told the episode at another rate than it was recorded at."""
    recorded = _recorded(episode)
    return recorded is not None and recorded.control_hz != control_hz


def operators_record(episode: ForeignEpisode, rows: StateRows) -> OperatorsRecord:
    """Return who drove each arm, as the column of sources says it, with the names that the recording had."""
    named = _named_shifts(episode)
    return OperatorsRecord(
        shifts={arm: _shifts(rows, i, named.get(arm, ())) for i, arm in enumerate(rows.arms)}
    )


def _shifts(rows: StateRows, arm: int, named: tuple[Shift, ...]) -> tuple[Shift, ...]:
    drivers = []
    for row in range(len(rows) - 1):
        source = int(rows.sources[row, arm])
        word = operator_word(source).value if source else _UNKNOWN  # type: ignore[arg-type]
        drivers.append((word, _name_at(named, int(rows.ticks[row] - rows.ticks[0]), word)))
    found, row = [], 0
    for (word, name), run in groupby(drivers):
        found.append(Shift(episode_tick=row, operator=word, name=name))
        row += len(list(run))
    return tuple(found)


def _name_at(named: tuple[Shift, ...], tick: int, word: str) -> str:
    """Return who of this kind drove then; the only one of the kind where ticks are counted otherwise."""
    of_kind = [shift for shift in named if shift.operator == word]
    before = [shift for shift in of_kind if shift.episode_tick <= tick]
    return (before or of_kind)[-1 if before else 0].name if of_kind else ""


def _named_shifts(episode: ForeignEpisode) -> Mapping[str, tuple[Shift, ...]]:
    strings = (
        episode.operators if episode.origin is None else episode.origin.records.get(OperatorsRecord.NAME, {})
    )
    try:
        return OperatorsRecord.from_strings(strings).shifts
    except Corrupt:
        return {}  # words of somebody else's


def _recorded(episode: ForeignEpisode) -> EpisodeRecord | None:
    strings = {} if episode.origin is None else episode.origin.records.get(EpisodeRecord.NAME, {})
    return EpisodeRecord.from_strings(strings) if strings else None


def _outcome(episode: ForeignEpisode, rows: StateRows, task: Task | None) -> str:
    said = episode.outcome if episode.origin is None else episode.origin.outcome
    if task is None:
        return EpisodeOutcome.UNSPECIFIED.value
    if said in tuple(EpisodeOutcome):
        return said
    return (EpisodeOutcome.SUCCESS if bool(rows.success[-1]) else EpisodeOutcome.UNSPECIFIED).value
