"""Say something about episodes afterwards: files never change, labels are appended to `labels.jsonl` beside them.

Each line says one thing about one file, and the newest of its kind holds. Deleting a line takes it back. What a line
says that this version does not know (another kind, another value, a torn line) is left where it is and counts nothing.

    from mart.episodes import labels

    labels.say(path, labels.LabelKind.OUTCOME, "failure", at_ns=clock.wall_ns())
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import Any

from mart.protocol.errors import Conflict, Corrupt, InvalidInput
from mart.protocol.vocabulary import EpisodeOutcome, Verdict
from mart.runtime.json_lines import append_json_lines, read_json_lines

_log = logging.getLogger(__name__)

FILE_NAME = "labels.jsonl"
MAX_NOTE_CHARACTERS = 2000
_MAX_PATH_CHARACTERS = 4096
_MAX_NS = 2**63  # 2262
_MAX_REASON_CHARACTERS = 200
KEEP, DROP = "keep", "drop"
_DAY = re.compile(r"\d{4}-\d{2}-\d{2}")
_DATASET = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")


class LabelKind(StrEnum):
    """Name what a label speaks of."""

    OUTCOME = "outcome"  # value: success, failure or discarded
    NOTE = "note"  # value: free text
    USE = "use"  # value: keep or drop (leave out of data sets)
    VERDICT = "verdict"  # value: verified, diverged or unverified, from a later re-simulation
    JOIN = "join"  # value: the name of a data set that it becomes part of (datasets.py)
    LEAVE = "leave"  # value: the name of a data set that it was part of


_ALLOWED: dict[LabelKind, tuple[str, ...]] = {
    LabelKind.OUTCOME: (EpisodeOutcome.SUCCESS, EpisodeOutcome.FAILURE, EpisodeOutcome.DISCARDED),
    LabelKind.USE: (KEEP, DROP),
    LabelKind.VERDICT: tuple(Verdict),
}


@dataclass(frozen=True)
class Label:
    """Say one thing about one file. Raises InvalidInput for a value that the kind cannot have, and for such a path.

    path: relative to the folder of the labels and below it, with forward slashes. at_ns: Unix time. by: who says it, as
    others see them; empty where that is not known.
    """

    path: str
    kind: LabelKind
    value: str
    at_ns: int
    detail: str = ""
    by: str = ""

    def __post_init__(self) -> None:
        _require_path(self.path)
        for text in (self.value, self.detail, self.by):
            _require_text(text)
        if not 0 <= self.at_ns < _MAX_NS:
            raise InvalidInput(f"A label of {self.at_ns} ns was given; it must be a time of before 2262.")
        allowed = _ALLOWED.get(self.kind)
        if allowed is not None and self.value not in allowed:
            raise InvalidInput(f"The {self.kind} {self.value!r} was given; it must be {', '.join(allowed)}.")
        if self.kind in (LabelKind.JOIN, LabelKind.LEAVE) and not _DATASET.fullmatch(self.value):
            raise InvalidInput(
                f"The data set {self.value[:100]!r} was given; name it with 1 to 64 lower-case letters, digits, '-' or "
                "'_', the first a letter or digit."
            )
        if len(self.value) > MAX_NOTE_CHARACTERS:
            raise InvalidInput(
                f"A note of {len(self.value)} characters was given; {MAX_NOTE_CHARACTERS} are allowed."
            )


@dataclass(frozen=True)
class EpisodeLabels:
    """Hold what is said about one file now; None where nothing was said.

    outcome_by: who said the outcome, empty where that is not known.
    datasets: the names of those that it is part of, and since when (Unix time, nanoseconds).
    """

    outcome: str | None = None
    outcome_by: str = ""
    note: str | None = None
    verdict: str | None = None
    dropped: bool = False
    datasets: Mapping[str, int] = field(default_factory=dict)

    def with_label(self, label: Label) -> EpisodeLabels:
        """Return what holds once `label` has been given."""
        match label.kind:
            case LabelKind.OUTCOME:
                return replace(self, outcome=label.value, outcome_by=label.by)
            case LabelKind.NOTE:
                return replace(self, note=label.value)
            case LabelKind.VERDICT:
                return replace(self, verdict=label.value)
            case LabelKind.USE:
                return replace(self, dropped=label.value == DROP)
            case LabelKind.JOIN:
                return replace(self, datasets={**self.datasets, label.value: label.at_ns})
            case LabelKind.LEAVE:
                kept = {name: at_ns for name, at_ns in self.datasets.items() if name != label.value}
                return replace(self, datasets=kept)


def fold(labels: Iterable[Label]) -> dict[str, EpisodeLabels]:
    """Return by path what holds about each file, out of labels in the order they were given."""
    known: dict[str, EpisodeLabels] = {}
    for label in labels:
        known[label.path] = known.get(label.path, EpisodeLabels()).with_label(label)
    return known


def carried(said: EpisodeLabels | None, old: str, new: str, at_ns: int) -> list[Label]:
    """Return the labels by which one file takes the place of another: what holds of it, and that the old is dropped.

    old, new: their paths, as labels name them. The verdict is not carried on: it is of the very bytes.
    """
    known = said or EpisodeLabels()
    texts = {LabelKind.OUTCOME: known.outcome, LabelKind.NOTE: known.note}
    found = [Label(new, kind, text, at_ns) for kind, text in texts.items() if text is not None]
    found += [Label(new, LabelKind.JOIN, name, at_ns) for name in known.datasets]
    found += [Label(new, LabelKind.USE, DROP, at_ns)] if known.dropped else []
    return [*found, Label(old, LabelKind.USE, DROP, at_ns, f"repaired as {new}")]


def read(root: Path) -> list[Label]:
    """Read every label of a folder of episodes, in the order they were given.

    Lines that are none (torn by a power cut, or of a kind that another version knows) are left out, and a warning says
    which, once as long as they stay the same. Raises Corrupt where the file cannot be read: who knows what it says.
    """
    found, unknown = [], dict[int, str]()
    try:
        for number, fields in read_json_lines(root / FILE_NAME):
            try:
                found.append(_parse(fields))
            except (ValueError, KeyError, InvalidInput) as error:
                unknown[number] = str(error)[:_MAX_REASON_CHARACTERS]
    except OSError as error:
        raise Corrupt(f"The labels {root / FILE_NAME} cannot be read: {error.strerror}.") from error
    _warn_once(root / FILE_NAME, unknown)
    return found


def read_folded(root: Path) -> dict[str, EpisodeLabels]:
    """Return by path, below `root`, what holds about each file of a folder of episodes."""
    return fold(read(root))


def append(root: Path, labels: Iterable[Label]) -> None:
    """Append labels to those of a folder: on the disk when this returns. Raises Conflict where it cannot be written."""
    path = root / FILE_NAME
    try:
        append_json_lines(path, map(_fields, labels))
    except OSError as error:
        raise Conflict(f"{path} could not be written: {error.strerror}.") from error


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


def _require_path(path: str) -> None:
    _require_text(path)
    parts = path.split("/")
    if not path.isprintable() or len(path) > _MAX_PATH_CHARACTERS or path.startswith("/") or ".." in parts:
        raise InvalidInput(
            f"A label for {path[:100]!r} was given; it must be a path below the folder, of at most "
            f"{_MAX_PATH_CHARACTERS} printable characters."
        )


def _require_text(text: str) -> None:
    """Raise InvalidInput where a text cannot be written as UTF-8, as the names of some files cannot."""
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise InvalidInput(
            f"{text[:100]!r} was given, which cannot be written as UTF-8; rename the file, or say it in other words."
        ) from error


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
