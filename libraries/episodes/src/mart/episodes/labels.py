"""What people say about episodes afterwards. Files never change; labels are appended to `labels.jsonl` beside them.

Each line says one thing about one file, and the newest of its kind holds. Deleting a line takes it back.
"""

from __future__ import annotations

import json
import logging
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path

from mart.protocol.errors import Conflict, InvalidInput

_log = logging.getLogger(__name__)

FILE_NAME = "labels.jsonl"
MAX_NOTE_CHARACTERS = 2000
_DAY = re.compile(r"\d{4}-\d{2}-\d{2}")
_DATASET = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")


class LabelKind(StrEnum):
    OUTCOME = "outcome"  # value: success, failure or discarded
    NOTE = "note"  # value: free text
    USE = "use"  # value: keep or drop (leave out of data sets)
    VERDICT = "verdict"  # value: verified, diverged or unverified, from a later re-simulation
    JOIN = "join"  # value: the name of a data set that it becomes part of (datasets.py)
    LEAVE = "leave"  # value: the name of a data set that it was part of


_ALLOWED = {
    LabelKind.OUTCOME: ("success", "failure", "discarded"),
    LabelKind.USE: ("keep", "drop"),
    LabelKind.VERDICT: ("verified", "diverged", "unverified"),
}


@dataclass(frozen=True)
class Label:
    """`path` is relative to the folder of the labels, with forward slashes."""

    path: str
    kind: LabelKind
    value: str
    at_ns: int  # Unix time
    detail: str = ""

    def __post_init__(self) -> None:
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
    """What holds about one file now; None where nothing was said. datasets: that it is part of, and since when."""

    outcome: str | None = None
    note: str | None = None
    verdict: str | None = None
    dropped: bool = False
    datasets: Mapping[str, int] = field(default_factory=dict)

    def with_label(self, label: Label) -> EpisodeLabels:
        match label.kind:
            case LabelKind.OUTCOME:
                return replace(self, outcome=label.value)
            case LabelKind.NOTE:
                return replace(self, note=label.value)
            case LabelKind.VERDICT:
                return replace(self, verdict=label.value)
            case LabelKind.USE:
                return replace(self, dropped=label.value == "drop")
            case LabelKind.JOIN:
                return replace(self, datasets={**self.datasets, label.value: label.at_ns})
            case LabelKind.LEAVE:
                kept = {name: at_ns for name, at_ns in self.datasets.items() if name != label.value}
                return replace(self, datasets=kept)


def fold(labels: Iterable[Label]) -> dict[str, EpisodeLabels]:
    """Path → what holds about it."""
    known: dict[str, EpisodeLabels] = {}
    for label in labels:
        known[label.path] = known.get(label.path, EpisodeLabels()).with_label(label)
    return known


def read(root: Path) -> list[Label]:
    """Every label in the order it was given. A line that is none (a power cut tore it) is logged and left out."""
    path = root / FILE_NAME
    if not path.exists():
        return []
    labels = []
    lines = (
        path.read_bytes().removesuffix(b"\n").split(b"\n")
    )  # a note may hold what str.splitlines splits at
    for number, line in enumerate(filter(None, lines), 1):
        try:
            labels.append(_parse(line))
        except (ValueError, KeyError, TypeError, InvalidInput) as error:
            _log.warning("%s, line %d is no label and is left out: %s", path, number, error)
    return labels


def append(root: Path, labels: Iterable[Label]) -> None:
    """On the disk when this returns; raises Conflict where the folder cannot be written."""
    path = root / FILE_NAME
    text = "".join(json.dumps(_fields(label), ensure_ascii=False) + "\n" for label in labels)
    try:
        with path.open("ab+") as file:
            torn = file.tell() > 0 and _last_byte(path) != b"\n"
            file.write((("\n" if torn else "") + text).encode())
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise Conflict(f"{path} could not be written: {error.strerror}.") from error


def root_of(episode: Path) -> Path:
    """The folder that the labels and the catalogue of an episode file are in."""
    folder = episode.resolve().parent
    return folder.parent if _DAY.fullmatch(folder.name) else folder


def is_root(folder: Path) -> bool:
    """Whether labels and catalogue belong into this folder: it holds days of episodes."""
    return any(_DAY.fullmatch(child.name) for child in folder.iterdir())


def say(episode: Path, kind: LabelKind, value: str, at_ns: int, detail: str = "") -> None:
    """Appends one label about an episode file. Raises InvalidInput for a value that the kind cannot have."""
    root = root_of(episode)
    append(root, [Label(episode.resolve().relative_to(root).as_posix(), kind, value, at_ns, detail)])


def _last_byte(path: Path) -> bytes:
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        return file.read(1)


def _fields(label: Label) -> dict[str, object]:
    fields = {"at_ns": label.at_ns, "path": label.path, "kind": label.kind.value, "value": label.value}
    return fields | ({"detail": label.detail} if label.detail else {})


def _parse(line: bytes) -> Label:
    fields = json.loads(line)
    return Label(
        path=str(fields["path"]),
        kind=LabelKind(fields["kind"]),
        value=str(fields["value"]),
        at_ns=int(fields["at_ns"]),
        detail=str(fields.get("detail", "")),
    )
