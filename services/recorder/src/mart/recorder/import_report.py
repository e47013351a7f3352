"""Say what was imported and what was left out. Pure."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mart.recorder.importing.foreign_episode import NotImported
from mart.recorder.importing.import_episodes import Imported

_SHOWN = 20


def told(source: Path, out: Path, report: Sequence[Imported | NotImported]) -> tuple[dict[str, Any], str]:
    """Return the report as a JSON object and in words."""
    done = [one for one in report if isinstance(one, Imported)]
    left = [one for one in report if isinstance(one, NotImported)]
    result = {
        "source": str(source),
        "out": str(out),
        "episodes": [vars(one) | {"path": str(one.path)} for one in done],
        "left_out": [vars(one) for one in left],
    }
    lines = [
        f"{one.name}: {one.path} ({one.task or 'to be looked at only'}, {one.ticks} ticks, {one.verdict}). {one.detail}"
        for one in done
    ]
    lines += [f"{one.name}: {sentence}" for one in done for sentence in one.left_out]
    lines += [f"{one.name} was left out: {one.why}" for one in left[:_SHOWN]]
    if len(left) > _SHOWN:
        lines.append(f"{len(left) - _SHOWN} more were left out; --json names each.")
    lines.append(f"{len(done)} of {len(report)} episodes of {source} are in {out}.")
    return result, "\n".join(lines)


def is_whole(report: Sequence[Imported | NotImported]) -> bool:
    """Tell whether something was there and all of it was taken, or had been before."""
    return bool(report) and all(
        isinstance(one, Imported) or one.why.startswith("it is there already") for one in report
    )
