"""Say something about episodes afterwards: files never change, labels are appended to `labels.jsonl` beside them.

Each line says one thing about one file, or the same about several, and the newest of its kind holds; of edits
(edits.py) all hold. All lines of one act have the same stamp, by which a later line undoes it. What a line says that
this version does not know (another kind, another value, a torn line) is left where it is and counts nothing.

    from mart.episodes import labels

    labels.say(path, labels.LabelKind.OUTCOME, "failure", at_ns=clock.wall_ns())
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import BinaryIO

from mart.episodes.episode_labels import EpisodeLabels, carried, fold, standing
from mart.episodes.followed_labels import FollowedLabels
from mart.episodes.label import DROP, KEEP, MAX_NOTE_CHARACTERS, Label, LabelKind
from mart.episodes.label_format import lines_of
from mart.protocol.errors import Conflict, Corrupt
from mart.runtime.json_lines import alone_with, append_lines

__all__ = [
    "DROP", "FILE_NAME", "KEEP", "MAX_NOTE_CHARACTERS", "EpisodeLabels", "Label", "LabelKind", "append",
    "append_missing", "carried", "fold", "is_root", "read", "read_folded", "resolved", "root_of", "say", "standing",
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


def append(root: Path, labels: Iterable[Label]) -> int:
    """Append the labels of one act to those of a folder, and return the act's stamp (Unix time); 0: there are none.

    The stamp is the newest of the labels', or the next that is later than all that was said of these files before, so
    that it holds whatever the clock does. On the disk when this returns, whoever else appends meanwhile.
    Raises Conflict where it cannot be written.
    """
    act = list(labels)
    if not act:
        return 0
    with _alone(root) as file:
        newest_ns = max(label.at_ns for label in act)
        stamp = _followed(root / FILE_NAME).stamp_after(newest_ns, {label.path for label in act})
        stamped = [label if label.at_ns == stamp else replace(label, at_ns=stamp) for label in act]
        append_lines(file, lines_of(stamped))
    return stamp


def append_missing(root: Path, labels: Iterable[Label]) -> int:
    """Append what was said elsewhere, with the stamps it has; what stands there already is not said twice.

    Returns how many labels are new. Raises Conflict where they cannot be written.
    """
    with _alone(root) as file:
        known = set(_followed(root / FILE_NAME).read()[0])
        new = [label for label in dict.fromkeys(labels) if label not in known]
        if new:
            append_lines(file, lines_of(new))
    return len(new)


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


@contextmanager
def _alone(root: Path) -> Iterator[BinaryIO]:
    path = root / FILE_NAME
    try:
        with alone_with(path) as file:
            yield file
    except OSError as error:
        raise Conflict(f"{path} could not be written: {error.strerror}.") from error


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
    return FollowedLabels(path)


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
