"""Bring labels to a store and back as a union of lines: none is lost and none doubled, whoever pushes at once.

Each push that has something new to say writes one file of lines, named by its digest, which never changes.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterable
from pathlib import Path

from mart.episodes import labels
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
    new = [line for line in dict.fromkeys(map(labels.line_of, wanted)) if line not in known]
    if new:
        data = b"".join(line + b"\n" for line in new)
        name = f"{FOLDER}/{hashlib.sha256(data).hexdigest()}.jsonl"
        store.files.pipe_file(store.key(name), data)
    return len(new)


def pull_lines(store: Store, names: Iterable[str], root: Path) -> int:
    """Append what the store's files say of the episodes in `root` and nobody has said there; return how many lines."""
    known = {labels.line_of(label) for label in labels.read(root)}
    found = [labels.label_of(line) for line in dict.fromkeys(_lines(store, names)) if line not in known]
    new = [label for label in found if label is not None and (root / label.path).is_file()]
    if new:
        labels.append(root, sorted(new, key=lambda label: label.at_ns))
    return len(new)


def _lines(store: Store, names: Iterable[str]) -> list[bytes]:
    found: list[bytes] = []
    left_bytes = _MAX_BYTES
    for name in sorted(filter(is_labels, names)):
        data = store.read(name, left_bytes)
        left_bytes -= len(data)
        found += filter(None, data.split(b"\n"))
    return found
