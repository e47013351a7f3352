"""Tell of edited episodes in words and in JSON, for the command line."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from mart.recorder.catalogue.episode_editing import EditedEpisode, kept_text


def edited(done: Sequence[EditedEpisode]) -> tuple[dict[str, Any], str]:
    """Return how episodes are edited now, as JSON and in words."""
    return {"episodes": [_json(one) for one in done]}, "\n".join(map(_text, done)) or "There are no episodes."


def _json(done: EditedEpisode) -> dict[str, Any]:
    row = done.episode
    segments = row.edits.runs(row.ticks)
    kept = row.edits.kept(row.ticks)
    return {
        "path": str(row.file_path),
        "ticks": row.ticks,
        "kept_ticks": kept,
        "kept_s": kept / row.control_hz if row.control_hz else None,
        "segments": [[list(one) for one in segment] for segment in segments],
        "edits": row.edits.model_dump(),
        "acts": [
            {"at_ns": act.at_ns, "by": act.by, "said": [[kind.value, value] for kind, value in act.said]}
            for act in done.acts
        ],
        "act_ns": done.act_ns or None,
    }


def _text(done: EditedEpisode) -> str:
    row = done.episode
    if not done.acts:
        return f"{row.file_path}: not edited, {row.ticks} ticks ({row.simulated_s:.1f} s)."
    kept_s = row.edits.kept(row.ticks) / row.control_hz if row.control_hz else 0.0
    lines = [f"{row.file_path}: {kept_text(row)} ({kept_s:.1f} of {row.simulated_s:.1f} s)."]
    for number, segment in enumerate(row.edits.runs(row.ticks), 1):
        lines.append(f"  segment {number}: ticks {', '.join(f'{start}-{end}' for start, end in segment)}")
    for act in done.acts:
        when = datetime.fromtimestamp(act.at_ns / 1e9, UTC).isoformat(sep=" ", timespec="seconds")[:19]
        lines.append(f"  {when} UTC{f', {act.by}' if act.by else ''}: {act}")
    return "\n".join(lines)
