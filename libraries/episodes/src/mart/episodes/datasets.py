"""Put episodes together under a name, to be learned from as one: named data sets. Pure.

An episode joins and leaves a data set by a label, so a data set outlives the catalogue, no change is ever lost, and
what it held at any time can be told. All labels of one act have the same stamp: by it the act is undone. A data set
that holds nothing is none.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from mart.episodes.edits import EpisodeEdits
from mart.episodes.episode_labels import NOTHING_SAID
from mart.episodes.labels import EpisodeLabels, Label, LabelKind
from mart.protocol.errors import NotFound

_OPPOSITE = {LabelKind.JOIN: LabelKind.LEAVE, LabelKind.LEAVE: LabelKind.JOIN}


@dataclass(frozen=True)
class NamedDataSet:
    """Name episodes that people have put together.

    episodes: paths below the folder of the labels, rising. created_ns: when the first joined (Unix time).
    edits: of those that are edited, by path.
    """

    name: str
    episodes: tuple[str, ...]
    created_ns: int
    edits: Mapping[str, EpisodeEdits] = field(default_factory=dict)

    @property
    def sha256(self) -> str:
        """Digest of the paths, a line each, with the edits of those that have any behind a tab.

        Files never change, so what has the same digest holds the same.
        """
        lines = (f"{path}\t{self.edits[path]}" if path in self.edits else path for path in self.episodes)
        return hashlib.sha256("".join(f"{line}\n" for line in lines).encode()).hexdigest()


def named(said: Mapping[str, EpisodeLabels]) -> dict[str, NamedDataSet]:
    """Return every data set, by its name, out of what holds about each file."""
    joined: dict[str, dict[str, int]] = {}
    for path, label in said.items():
        for name, at_ns in label.datasets.items():
            joined.setdefault(name, {})[path] = at_ns
    return {
        name: NamedDataSet(
            name,
            tuple(sorted(paths)),
            min(paths.values()),
            {path: said[path].edits for path in paths if said[path].edits},
        )
        for name, paths in sorted(joined.items())
    }


def find(said: Mapping[str, EpisodeLabels], name: str) -> NamedDataSet:
    """Return the data set of this name. Raises NotFound, naming those that there are."""
    known = named(said)
    if name not in known:
        raise NotFound.named("data set", name[:100], known)
    return known[name]


def join(
    said: Mapping[str, EpisodeLabels], name: str, paths: Iterable[str], at_ns: int, by: str = ""
) -> list[Label]:
    """Return the labels by which these episodes join; none for those that are in it.

    by: who says so, as others see them. Raises InvalidInput for a name that no data set can have.
    """
    return [
        Label(path, LabelKind.JOIN, name, at_ns, by=by)
        for path in dict.fromkeys(paths)
        if name not in said.get(path, NOTHING_SAID).datasets
    ]


def leave(
    said: Mapping[str, EpisodeLabels], name: str, paths: Iterable[str], at_ns: int, by: str = ""
) -> list[Label]:
    """Return the labels by which these episodes leave; none for those that are not in it."""
    return [
        Label(path, LabelKind.LEAVE, name, at_ns, by=by)
        for path in dict.fromkeys(paths)
        if name in said.get(path, NOTHING_SAID).datasets
    ]


def newest_act_ns(labels: Iterable[Label], name: str) -> int:
    """Return when this data set was last changed (Unix time). Raises NotFound where nothing was ever said about it."""
    stamps = [label.at_ns for label in labels if label.kind in _OPPOSITE and label.value == name]
    if not stamps:
        raise NotFound(f"There never was a data set {name[:100]!r}, so nothing of it can be undone.")
    return stamps[-1]


def undo(labels: Iterable[Label], name: str, act_ns: int, at_ns: int, by: str = "") -> list[Label]:
    """Return the labels by which what was done to this data set at `act_ns` holds no longer."""
    return [
        Label(label.path, _OPPOSITE[label.kind], name, at_ns, by=by)
        for label in labels
        if label.at_ns == act_ns and label.value == name and label.kind in _OPPOSITE
    ]
