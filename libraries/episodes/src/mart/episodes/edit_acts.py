"""Tell which acts of editing hold for an episode, and which of them is taken back or done again next. Pure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from mart.episodes.episode_labels import standing
from mart.episodes.label import EDITS, Label, LabelKind, undone_ns


@dataclass(frozen=True)
class EditAct:
    """Hold what somebody said at once about the ticks of one episode.

    at_ns: its stamp, by which it is undone (Unix time). said: kinds and values, as labels say them.
    """

    at_ns: int
    by: str
    said: tuple[tuple[LabelKind, str], ...]

    def __str__(self) -> str:
        return " ".join(f"{kind} {value}" for kind, value in self.said)


def edit_acts(labels: Sequence[Label]) -> list[EditAct]:
    """Return the acts of editing that hold, the oldest first. labels: of one file, in the order they were given."""
    acts: dict[int, list[Label]] = {}
    for label in standing(labels):
        if label.kind in EDITS:
            acts.setdefault(label.at_ns, []).append(label)
    return [
        EditAct(at_ns, said[0].by, tuple((one.kind, one.value) for one in said))
        for at_ns, said in acts.items()
    ]


def redoable_ns(labels: Sequence[Label]) -> int | None:
    """Return the stamp of the newest undo of an edit that holds; None where there is none, or an edit came after it.

    labels: of one file, in the order they were given.
    """
    edits = {label.at_ns for label in labels if label.kind in EDITS}
    undos = [label.at_ns for label in _standing_undos(labels) if undone_ns(label) in edits]
    return undos[0] if undos and undos[0] > max(edits) else None


def next_stamp(labels: Iterable[Label], now_ns: int) -> int:
    """Return the stamp of a new act: now, and later than all that was said of the file before: its own alone."""
    return max([now_ns, *(label.at_ns + 1 for label in labels)])


def _standing_undos(labels: Sequence[Label]) -> list[Label]:
    """Return the undos that nothing has undone, the newest first."""
    undone: set[int] = set()
    found = []
    for label in reversed(labels):
        if label.kind is LabelKind.UNDO and label.at_ns not in undone:
            undone.add(undone_ns(label))
            found.append(label)
    return found
