"""Tell of episodes in words and in JSON, for the command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from mart.episodes.datasets import NamedDataSet
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.recording import VerificationRecord, video_topic
from mart.protocol.vocabulary import EpisodeEndedBy
from mart.recorder.catalogue.dataset_editing import DataSetEdit
from mart.recorder.catalogue.episode_editing import kept_text
from mart.recorder.repair.repair import RepairResult
from mart.recorder.verify.file_check import FileCheck
from mart.recorder.verify.resimulation import ComparedStretch

_COLUMNS = ("path", "outcome", "verdict", "ticks", "real time", "operators", "")


def listed(episode: LabelledEpisode) -> dict[str, Any]:
    """Return one episode of `list --json`; its path is the one that was asked for."""
    return episode.model_dump() | {"path": str(episode.file_path), "verified": episode.verified}


def table(episodes: Sequence[LabelledEpisode], paths: Sequence[str] | None = None) -> str:
    """Return a line for each episode. paths: how they are named; None names their files."""
    if not episodes:
        return "There are no episodes."
    names = [str(episode.file_path) for episode in episodes] if paths is None else paths
    rows = (_cells(name, one) for name, one in zip(names, episodes, strict=True))
    cells = [_COLUMNS, *(tuple(map(_shown, row)) for row in rows)]
    widths = [max(len(line[i]) for line in cells) for i in range(len(_COLUMNS))]
    return "\n".join(
        "  ".join(c.ljust(w) for c, w in zip(line, widths, strict=True)).rstrip() for line in cells
    )


def _cells(path: str, row: LabelledEpisode) -> tuple[str, ...]:
    if row.error is not None:
        return (path, "–", "–", "–", "–", "–", row.error)
    marks = {
        "incomplete": not row.complete,
        f"{row.missing_commands} commands missing": row.missing_commands,
        "repaired": row.repaired,
        "paused": row.interrupted,
        "dropped": row.dropped,
        "verification pending": row.verification_pending,
    }
    remarks = [text for text in (ending(row), kept_text(row)) if text]
    remarks += [word for word, holds in marks.items() if holds] + ([row.note] if row.note else [])
    pace = "–" if row.real_time_factor is None else f"{row.real_time_factor:.3f}"
    drivers = ", ".join(f"{arm} {who}" for arm, who in row.operators.items())
    return (path, row.outcome, row.verdict, str(row.ticks), pace, drivers, "; ".join(remarks))


def ending(row: LabelledEpisode) -> str:
    """Return who ended an episode and how much of its task was done, where that does not go without saying."""
    parts = (
        [f"said by {row.ended_by_name or 'an operator'}"] if row.ended_by == EpisodeEndedBy.OPERATOR else []
    )
    if row.subtasks is not None and row.subtasks_done is not None and row.subtasks_done < row.subtasks:
        parts.append(f"{row.subtasks_done} of {row.subtasks} steps")
    return ", ".join(parts)


def model(file: EpisodeFile) -> str:
    """Say how the compiled model in a file stands: intact, none, or why it cannot be used."""
    try:
        return f"intact, {len(file.model())} bytes"
    except NotFound:
        return "none"
    except Corrupt as error:
        return str(error)


def pictures(file: EpisodeFile, arms: Sequence[str]) -> str:
    """Say whose view is in a file as it was recorded; whatever is not is drawn from the states when asked for."""
    kept = [arm for arm in arms if next(iter(file.messages(video_topic(arm))), None) is not None]
    return f"recorded of {', '.join(kept)}" if kept else "none; they are drawn from the states when asked for"


def _shown(text: str) -> str:
    """Return text from a file as a terminal may have it: what steers one, or is no text, becomes a sign for it."""
    return "".join(sign if sign.isprintable() else "\ufffd" for sign in text)


def details(result: Mapping[str, Any]) -> str:
    """Return nested facts as text, two spaces a level."""
    return "\n".join(_lines(result, ""))


def _lines(facts: Mapping[str, Any], indent: str) -> list[str]:
    lines = []
    for name, value in facts.items():
        if isinstance(value, Mapping):
            lines += [f"{indent}{name}", *_lines(value, indent + "  ")]
        elif value is not None:
            lines.append(f"{indent}{_shown(name)}: {_shown(str(value))}")
    return lines


def verified(path: Path, said: VerificationRecord) -> dict[str, Any]:
    """Return what `verify --json` says of one file; covers: what the verdict is about."""
    return {
        "path": str(path),
        "verdict": said.verdict.value,
        "detail": said.detail,
        "covers": "states and actions",
        "pending": bool(said.pending),
        "first_different_tick": said.first_different_tick,
        "within_tolerance": said.within_tolerance,
        "largest_difference": dict(said.largest_difference),
    }


def replayed(path: Path, stretches: Sequence[ComparedStretch]) -> tuple[dict[str, Any], str]:
    """Return what `replay` found, as JSON and in words."""
    told = [
        {"first_tick": s.first_tick, "last_tick": s.last_tick, "different": list(s.different)}
        for s in stretches
    ]
    lines = [f"{path}: {len(stretches)} stretch{'es' * (len(stretches) != 1)} without a missing tick"]
    lines += [f"  ticks {s.first_tick} to {s.last_tick}: {_agreement(s)}" for s in stretches]
    return {"path": str(path), "stretches": told}, "\n".join(lines)


def _agreement(stretch: ComparedStretch) -> str:
    if not stretch.different:
        return "the same, bit for bit"
    ticks = ", ".join(map(str, stretch.different[:10])) + (", …" if len(stretch.different) > 10 else "")
    return f"{len(stretch.different)} differ: {ticks}"


def checked(files: Sequence[FileCheck]) -> tuple[dict[str, Any], str]:
    """Return what `check` found, as JSON and in words."""
    told = [
        {
            "path": str(one.path),
            "whole": one.is_whole,
            "missing_ticks": one.missing_ticks,
            "missing_commands": one.missing_commands,
            "error": one.error,
        }
        for one in files
    ]
    lines = [f"{one.path}: {_lacks(one)}." for one in files]
    whole = sum(one.is_whole for one in files)
    lines += [f"{whole} of {len(files)} are whole."] if len(files) > 1 else []
    return {"episodes": told}, "\n".join(lines) or "There are no episodes."


def _lacks(one: FileCheck) -> str:
    if one.error is not None:
        return one.error.rstrip(".")
    missing = {"ticks": one.missing_ticks, "commands": one.missing_commands}
    return ", ".join(f"{count} {what} are missing" for what, count in missing.items() if count) or "whole"


def repaired(repaired: Sequence[RepairResult]) -> tuple[dict[str, Any], str]:
    """Return what `repair` did, as JSON and in words."""
    told = [
        {"file": str(r.source), "path": str(r.saved.path) if r.saved else None, "detail": r.detail}
        for r in repaired
    ]
    lines = [_repaired_line(one) for one in repaired]
    return {"repaired": told}, "\n".join(lines) or "There is nothing to repair."


def _repaired_line(one: RepairResult) -> str:
    if one.saved is None:
        return f"{one.source}: {'' if one.needless else 'not repaired. '}{one.detail}"
    return f"{one.source} → {one.saved.path}. {one.detail}"


def dataset(found: NamedDataSet) -> dict[str, Any]:
    """Return a data set as JSON."""
    return {
        "name": found.name,
        "count": len(found.episodes),
        "sha256": found.sha256,
        "created": datetime.fromtimestamp(found.created_ns / 1e9, UTC).isoformat(timespec="seconds"),
    }


def dataset_table(told: Sequence[Mapping[str, Any]]) -> str:
    """Return a line for each data set."""
    if not told:
        return "There are no data sets. `mart datasets create NAME` makes one of all good episodes."
    return "\n".join(map(_dataset_line, told))


def dataset_text(found: NamedDataSet, held: Sequence[LabelledEpisode], left_out: Mapping[str, str]) -> str:
    """Return a data set in words. left_out: why each episode is not learned from, empty for one that is."""
    unfit = [f"Left out of a training: {path} ({why})." for path, why in left_out.items() if why]
    return "\n".join([_dataset_line(dataset(found)), table(held, [one.path for one in held]), *unfit])


def curated(done: DataSetEdit, what: str) -> tuple[dict[str, Any], str]:
    """Return what changed in a data set, as JSON and in words. what: the verb (`put into it`)."""
    told = dataset(done.dataset) | {"changed": done.changed, "left_out": dict(done.left_out)}
    left_out = ", ".join(f"{count} {why}" for why, count in sorted(done.left_out.items()))
    held = len(done.dataset.episodes)
    text = f"{done.dataset.name}: {done.changed} {_episodes(done.changed)} {what}, it holds {held} now"
    return told, f"{text}; left out: {left_out}." if left_out else f"{text}."


def _dataset_line(told: Mapping[str, Any]) -> str:
    count = told["count"]
    return f"{told['name']}  {count} {_episodes(count)}  {told['sha256'][:12]}  since {told['created']}"


def _episodes(count: int) -> str:
    return "episode" if count == 1 else "episodes"
