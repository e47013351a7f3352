"""Tell what holds of each episode now, out of all that was said about it. Pure."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from operator import attrgetter
from typing import Any

from mart.episodes.edits import EpisodeEdits
from mart.episodes.label import DROP, EDITS, Label, LabelKind, undone_ns

_NO_EDITS = EpisodeEdits()


@dataclass(frozen=True)
class EpisodeLabels:
    """Hold what is said about one file now; None where nothing was said.

    outcome_by: who said the outcome, empty where that is not known.
    datasets: the names of those that it is part of, and since when (Unix time, nanoseconds).
    edits: what of it is left out, split or told otherwise.
    """

    outcome: str | None = None
    outcome_by: str = ""
    note: str | None = None
    verdict: str | None = None
    dropped: bool = False
    datasets: Mapping[str, int] = field(default_factory=dict)
    edits: EpisodeEdits = _NO_EDITS

    def with_label(self, label: Label) -> EpisodeLabels:
        """Return what holds once `label` has been given."""
        kind, value = label.kind, label.value
        if kind in EDITS:
            return replace(self, edits=EDITS[kind](self.edits, value))
        return replace(self, **self._changes(kind, value, label))

    def _changes(self, kind: LabelKind, value: str, label: Label) -> dict[str, Any]:
        others = {name: at_ns for name, at_ns in self.datasets.items() if name != value}
        match kind:
            case LabelKind.OUTCOME:
                return {"outcome": value, "outcome_by": label.by}
            case LabelKind.USE:
                return {"dropped": value == DROP}
            case LabelKind.JOIN:
                return {"datasets": {**others, value: label.at_ns}}
            case LabelKind.LEAVE:
                return {"datasets": others}
            case LabelKind.NOTE | LabelKind.VERDICT:
                return {kind.value: value}
            case _:
                return {}  # an undo: `standing` has heard it


NOTHING_SAID = EpisodeLabels()


def fold(labels: Iterable[Label]) -> dict[str, EpisodeLabels]:
    """Return by path what holds about each file, out of labels in the order they were given.

    What was said later holds, also where labels of several folders were put together; of one moment, what stands later.
    """
    by_path: dict[str, list[Label]] = {}
    for label in labels:
        by_path.setdefault(label.path, []).append(label)
    return {
        path: reduce(EpisodeLabels.with_label, standing(sorted(said, key=attrgetter("at_ns"))), NOTHING_SAID)
        for path, said in by_path.items()
    }


def standing(labels: Sequence[Label]) -> list[Label]:
    """Return, of the labels of one file in the order they were given, those that nothing has undone, undos left out."""
    undone: set[int] = set()
    kept: list[Label] = []
    for label in reversed(labels):
        if label.at_ns in undone:
            continue
        if label.kind is LabelKind.UNDO:
            undone.add(undone_ns(label))
        else:
            kept.append(label)
    return kept[::-1]


def carried(said: EpisodeLabels | None, old: str, new: str, at_ns: int) -> list[Label]:
    """Return the labels by which one file takes the place of another: what holds of it, and that the old is dropped.

    old, new: their paths, as labels name them. The verdict is not carried on: it is of the very bytes.
    """
    known = said or NOTHING_SAID
    texts = {LabelKind.OUTCOME: known.outcome, LabelKind.NOTE: known.note}
    found = [Label(new, kind, text, at_ns) for kind, text in texts.items() if text is not None]
    found += [Label(new, LabelKind.JOIN, name, at_ns) for name in known.datasets]
    found += [Label(new, LabelKind(kind), text, at_ns) for kind, text in known.edits.values()]
    found += [Label(new, LabelKind.USE, DROP, at_ns)] if known.dropped else []
    return [*found, Label(old, LabelKind.USE, DROP, at_ns, f"repaired as {new}")]
