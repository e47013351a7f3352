"""Say something about episodes afterwards: files never change, labels are appended to `labels.jsonl` beside them.

Each line says one thing about one file, and the newest of its kind holds; of edits (edits.py) all hold. All lines of
one act have the same stamp, by which a later line undoes it. What a line says that this version does not know (another
kind, another value, a torn line) is left where it is and counts nothing.

    from mart.episodes import labels

    labels.say(path, labels.LabelKind.OUTCOME, "failure", at_ns=clock.wall_ns())
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from mart.episodes.episode_labels import EpisodeLabels, carried, fold, standing
from mart.episodes.followed_labels import FollowedLabels
from mart.episodes.label import DROP, KEEP, MAX_NOTE_CHARACTERS, Label, LabelKind
from mart.protocol.errors import Conflict, Corrupt, InvalidInput
from mart.runtime.json_lines import append_json_lines, json_line, json_object

__all__ = [
    "DROP", "FILE_NAME", "KEEP", "MAX_NOTE_CHARACTERS", "EpisodeLabels", "Label", "LabelKind", "append", "carried",
    "fold", "is_root", "label_of", "line_of", "read", "read_folded", "resolved", "root_of", "say", "standing",
]  # fmt: skip

_log = logging.getLogger(__name__)

FILE_NAME = "labels.jsonl"
_MAX_FOLLOWED = 4  # folders whose labels stay in memory
_DAY = re.compile(r"\d{4}-\d{2}-\d{2}")


def read(root: Path) -> list[Label]:
    """Read every label of a folder of episodes, in the order they were given.

    Lines that are none (torn by a power cut, or of a kind that another version knows) are left out, and a warning says
    which, once as long as they stay the same. Raises Corrupt where the file cannot be read: who knows what it says.
    """
    return _read(root)[0]


def read_folded(root: Path) -> dict[str, EpisodeLabels]:
    """Return by path, below `root`, what holds about each file of a folder of episodes. Raises Corrupt as `read`."""
    return _read(root)[1]


def append(root: Path, labels: Iterable[Label]) -> None:
    """Append labels to those of a folder: on the disk when this returns. Raises Conflict where it cannot be written."""
    path = root / FILE_NAME
    try:
        append_json_lines(path, map(_fields, labels))
    except OSError as error:
        raise Conflict(f"{path} could not be written: {error.strerror}.") from error


def line_of(label: Label) -> bytes:
    """Return the line, without its end, that a label is written as."""
    return json_line(_fields(label))


def label_of(line: bytes) -> Label | None:
    """Return what a line says; None where it is no label that this version knows."""
    try:
        return _parse(json_object(line))
    except (ValueError, KeyError, InvalidInput):
        return None


def root_of(episode: Path) -> Path:
    """Return the folder that the labels and the catalogue of an episode file are in."""
    folder = resolved(episode).parent
    return folder.parent if _DAY.fullmatch(folder.name) else folder


def resolved(path: Path) -> Path:
    """Return where a path leads, absolute; of a link that leads to itself, where it lies."""
    try:
        return path.resolve()
    except (OSError, RuntimeError):
        return path.parent.resolve() / path.name


def is_root(folder: Path) -> bool:
    """Tell whether labels and catalogue belong into this folder: it holds days of episodes."""
    return any(_DAY.fullmatch(child.name) for child in folder.iterdir())


def say(episode: Path, kind: LabelKind, value: str, at_ns: int, detail: str = "") -> None:
    """Append one label about an episode file. Raises InvalidInput for a value that the kind cannot have."""
    root = root_of(episode)
    append(root, [Label(resolved(episode).relative_to(root).as_posix(), kind, value, at_ns, detail)])


def _fields(label: Label) -> dict[str, object]:
    fields = {"at_ns": label.at_ns, "path": label.path, "kind": label.kind.value, "value": label.value}
    return fields | {name: text for name, text in (("detail", label.detail), ("by", label.by)) if text}


def _parse(fields: Mapping[str, Any] | None) -> Label:
    if fields is None:
        raise ValueError("it is not one JSON object")
    at_ns, detail, by = fields["at_ns"], fields.get("detail", ""), fields.get("by", "")
    said = fields["path"], fields["kind"], fields["value"], detail, by
    if not isinstance(at_ns, int) or not all(isinstance(text, str) for text in said):
        raise ValueError("its time is no whole number, or what it says no text")
    return Label(fields["path"], LabelKind(fields["kind"]), fields["value"], at_ns, detail, by)


def _read(root: Path) -> tuple[list[Label], dict[str, EpisodeLabels]]:
    path = root / FILE_NAME
    try:
        found, folded, unknown = _followed(path).read()
    except OSError as error:
        raise Corrupt(f"The labels {path} cannot be read: {error.strerror}.") from error
    _warn_once(path, unknown)
    return found, folded


@lru_cache(maxsize=_MAX_FOLLOWED)
def _followed(path: Path) -> FollowedLabels:
    return FollowedLabels(path, _parse)


_warned: dict[Path, frozenset[int]] = {}  # file → lines; a catalogue reads its labels every second


def _warn_once(path: Path, unknown: Mapping[int, str]) -> None:
    lines = frozenset(unknown)
    if lines and _warned.get(path) != lines:
        first = min(lines)
        _log.warning(
            "%s: line %s no label that this version knows; left as it stands, it counts nothing (line %d: %s).",
            path,
            f"{first} is" if len(lines) == 1 else f"{first} and {len(lines) - 1} more are",
            first,
            unknown[first],
        )
    _warned[path] = lines
