"""Say one thing about one episode file: what a label can speak of, and what each kind of label can say. Pure."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

from mart.episodes.edits import EpisodeEdits
from mart.protocol.errors import InvalidInput
from mart.protocol.vocabulary import EpisodeOutcome, Verdict

MAX_NOTE_CHARACTERS = 2000
_MAX_PATH_CHARACTERS = 4096
_MAX_NS = 2**63  # 2262
KEEP, DROP = "keep", "drop"
_DATASET = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")


class LabelKind(StrEnum):
    """Name what a label speaks of."""

    OUTCOME = "outcome"  # value: success, failure or discarded
    NOTE = "note"  # value: free text
    USE = "use"  # value: keep or drop (leave out of data sets)
    VERDICT = "verdict"  # value: verified, diverged or unverified, from a later re-simulation
    JOIN = "join"  # value: the name of a data set that it becomes part of (datasets.py)
    LEAVE = "leave"  # value: the name of a data set that it was part of
    CUT = "cut"  # value: a range of ticks that is left out, such as 12-40 (edits.py)
    SKIP = "skip"  # value: a range of ticks that is left out as if it had not been
    SPLIT = "split"  # value: the tick at which a new segment begins
    SUBTASK = "subtask"  # value: from which tick on a subtask is done, such as grasp=85
    UNDO = "undo"  # value: the stamp, in nanoseconds, of what holds no longer; of an undo: what holds again


EDITS: Mapping[LabelKind, Callable[[EpisodeEdits, str], EpisodeEdits]] = {
    LabelKind.CUT: EpisodeEdits.with_cut,
    LabelKind.SKIP: EpisodeEdits.with_skip,
    LabelKind.SPLIT: EpisodeEdits.with_split,
    LabelKind.SUBTASK: EpisodeEdits.with_subtask,
}
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
        _require_value(self.kind, self.value)
        for text in (self.detail, self.by):
            _require_text(text)
        if not 0 <= self.at_ns < _MAX_NS:
            raise InvalidInput(f"A label of {self.at_ns} ns was given; it must be a time of before 2262.")
        if self.kind is LabelKind.UNDO:
            undone_ns(self)


def undone_ns(label: Label) -> int:
    """Return the stamp of what an undo takes back. Raises InvalidInput for a value that is none of before."""
    text = label.value
    if not (text.isascii() and text.isdecimal() and len(text) <= 19 and int(text) < label.at_ns):
        raise InvalidInput(
            f"Undoing {text[:100]!r} was asked for; give the stamp of what was said before, in nanoseconds."
        )
    return int(text)


@lru_cache(maxsize=1024)  # what is said of many files is looked at once
def _require_value(kind: LabelKind, value: str) -> None:
    _require_text(value)
    allowed = _ALLOWED.get(kind)
    if allowed is not None and value not in allowed:
        raise InvalidInput(f"The {kind} {value!r} was given; it must be {', '.join(allowed)}.")
    if kind in (LabelKind.JOIN, LabelKind.LEAVE) and not _DATASET.fullmatch(value):
        raise InvalidInput(
            f"The data set {value[:100]!r} was given; name it with 1 to 64 lower-case letters, digits, '-' or "
            "'_', the first a letter or digit."
        )
    if kind in EDITS:
        EDITS[kind](EpisodeEdits(), value)
    if len(value) > MAX_NOTE_CHARACTERS:
        raise InvalidInput(f"A note of {len(value)} characters was given; {MAX_NOTE_CHARACTERS} are allowed.")


@lru_cache(maxsize=32_768)  # each file is spoken of again and again
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
        if not text.isascii():
            text.encode()
    except UnicodeEncodeError as error:
        raise InvalidInput(
            f"{text[:100]!r} was given, which cannot be written as UTF-8; rename the file, or say it in other words."
        ) from error
