"""Bring labels to a store and back as a union of lines: none is lost and none doubled, whoever pushes at once.

Each push that has something new to say writes one file of lines, named by its digest, which never changes.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterable
from operator import attrgetter
from pathlib import Path

from mart.episodes import labels
from mart.episodes.label_format import labels_of, line_of
from mart.recorder.storage.store import Store

FOLDER = "labels"
_MAX_BYTES = 256 * 1024 * 1024


def is_labels(name: str) -> bool:
    """Tell whether a file in a store holds lines of labels."""
    return name.startswith(f"{FOLDER}/") and name.endswith(".jsonl")


def push_lines(store: Store, names: Iterable[str], root: Path, episodes: Collection[str]) -> int:
    """Write what is said about these episodes and not in the store yet; return how many lines that were."""
    known = set(_lines(store, names))
    wanted = [label for label in labels.read(root) if label.path in episodes]
    new = [line for line in dict.fromkeys(map(line_of, wanted)) if line not in known]
    if new:
        data = b"".join(line + b"\n" for line in new)
        name = f"{FOLDER}/{hashlib.sha256(data).hexdigest()}.jsonl"
        store.files.pipe_file(store.key(name), data)
    return len(new)


def pull_lines(store: Store, names: Iterable[str], root: Path) -> int:
    """Append what the store's files say of the episodes in `root` and nobody has said there; return how many lines."""
    found = [label for line in dict.fromkeys(_lines(store, names)) for label in labels_of(line)]
    known = set(labels.read(root))
    new = [label for label in found if label not in known and (root / label.path).is_file()]
    return labels.append_missing(root, sorted(new, key=attrgetter("at_ns"))) if new else 0


def _lines(store: Store, names: Iterable[str]) -> list[bytes]:
    found: list[bytes] = []
    left_bytes = _MAX_BYTES
    for name in sorted(filter(is_labels, names)):
        data = store.read(name, left_bytes)
        left_bytes -= len(data)
        found += filter(None, data.split(b"\n"))
    return found
