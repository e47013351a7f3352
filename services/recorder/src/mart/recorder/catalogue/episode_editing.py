"""Edit one episode, and take edits back: what the command line and the catalogue share. Only labels are written.

Each act says `by` whom it is, as others see them; empty where that is not known.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from mart.episodes import labels
from mart.episodes.arrays import arrays_from_states
from mart.episodes.edit_acts import EditAct, edit_acts, next_stamp, redoable_ns
from mart.episodes.edits import EpisodeEdits, parse_range, parse_subtask, parse_tick, range_text
from mart.episodes.idle import idle_ranges
from mart.episodes.label import EDITS
from mart.episodes.labelled_episode import LabelledEpisode, describe
from mart.episodes.labels import Label, LabelKind
from mart.protocol.errors import InvalidInput, NotFound

MAX_EDITS = 500  # of one act
MAX_STANDING_EDITS = 2000  # of one episode
_UNDONE_BY_STAMP = frozenset({*EDITS, LabelKind.OUTCOME, LabelKind.NOTE, LabelKind.USE})

Said = tuple[LabelKind, str]


@dataclass(frozen=True)
class EditedEpisode:
    """Hold an episode as it is now, the acts of editing that hold, and the stamp of what was just done; 0: nothing."""

    episode: LabelledEpisode
    acts: tuple[EditAct, ...]
    act_ns: int = 0


def as_it_is(row: LabelledEpisode, act_ns: int = 0) -> EditedEpisode:
    """Return an episode with the edits that hold now, whoever said them."""
    said = _labels_of(row)
    known = describe(row.file_path, row.path).with_labels(labels.fold(said).get(row.path))
    return EditedEpisode(known, tuple(edit_acts(said)), act_ns)


def check(row: LabelledEpisode, said: Sequence[Said]) -> None:
    """Raise InvalidInput for edits that an episode cannot have beside those it has, or that leave nothing of it."""
    if row.error is not None:
        raise InvalidInput(row.error)
    if len(said) > MAX_EDITS:
        raise InvalidInput(f"{len(said)} edits were given at once; at most {MAX_EDITS} can be.")
    edits = as_it_is(row).episode.edits
    for kind, value in said:
        if kind not in EDITS:
            raise InvalidInput(f"The edit {kind} was given; it must be {', '.join(EDITS)}.")
        _require_within(row, kind, value)
        edits = EDITS[kind](edits, value)
    if len(edits.values()) > MAX_STANDING_EDITS:
        raise InvalidInput(
            f"{row.file_path} would have more than {MAX_STANDING_EDITS} edits; drop it instead."
        )
    if not edits.kept(row.ticks):
        raise InvalidInput(
            f"Nothing would be left of {row.file_path}, so nothing was written; drop it instead "
            "(`mart episodes label --drop`)."
        )


def edit(row: LabelledEpisode, said: Sequence[Said], now_ns: int, by: str = "") -> EditedEpisode:
    """Say edits of an episode, all of one act; none leave it as it is. Raises InvalidInput as `check`."""
    check(row, said)
    return _act(row, said, now_ns, by)


def idle_skips(row: LabelledEpisode, min_s: float) -> list[Said]:
    """Return, as edits, the stretches of at least so many seconds in which no arm moves and that are still told.

    Raises InvalidInput for less seconds than idle time can have, and where ticks or poses are missing.
    """
    edits = as_it_is(row).episode.edits
    states = row.open().states()
    found = idle_ranges(arrays_from_states(states, with_integration_states=False), min_s)
    left = edits.kept(row.ticks)
    return [
        (LabelKind.SKIP, range_text(one)) for one in found if edits.with_skips([one]).kept(row.ticks) < left
    ]


def undo(row: LabelledEpisode, act_ns: int | None, now_ns: int, by: str = "") -> EditedEpisode:
    """Take back one act of an episode by its stamp; None: its newest act of editing. The new stamp undoes the undo.

    Raises NotFound where no such act holds, and InvalidInput for one that is undone elsewhere: a data set's.
    """
    said = _labels_of(row)
    if act_ns is None:
        acts = edit_acts(said)
        if not acts:
            raise NotFound(f"{row.file_path} has no edits, so none can be undone.")
        act_ns = acts[-1].at_ns
    kinds = {label.kind for label in labels.standing(said) if label.at_ns == act_ns}
    kinds |= {label.kind for label in said if label.at_ns == act_ns and label.kind is LabelKind.UNDO}
    if not kinds:
        raise NotFound(
            f"Nothing that holds was said of {row.file_path} at {act_ns}, so nothing can be undone."
        )
    if not kinds <= _UNDONE_BY_STAMP | {LabelKind.UNDO}:
        raise InvalidInput(
            "Only edits, outcomes, notes and drops are undone so; data sets have `mart datasets undo`."
        )
    return _act(row, [(LabelKind.UNDO, str(act_ns))], now_ns, by)


def redo(row: LabelledEpisode, now_ns: int, by: str = "") -> EditedEpisode:
    """Do again what the newest undo took back. Raises NotFound where there is none, or edits were made since."""
    undone = redoable_ns(_labels_of(row))
    if undone is None:
        raise NotFound(
            f"Nothing of {row.file_path} was undone since its newest edit, so nothing can be done again."
        )
    return _act(row, [(LabelKind.UNDO, str(undone))], now_ns, by)


def _act(row: LabelledEpisode, said: Iterable[Said], now_ns: int, by: str) -> EditedEpisode:
    stamp = next_stamp(_labels_of(row), now_ns)
    act = [Label(row.path, kind, value, stamp, by=by) for kind, value in dict.fromkeys(said)]
    return as_it_is(row, labels.append(labels.root_of(row.file_path), act))


def _labels_of(row: LabelledEpisode) -> list[Label]:
    return [label for label in labels.read(labels.root_of(row.file_path)) if label.path == row.path]


def _require_within(row: LabelledEpisode, kind: LabelKind, value: str) -> None:
    """Raise InvalidInput for ticks that an episode has not, and for a subtask that its task has not."""
    name, last = "", row.ticks
    if kind is LabelKind.SPLIT:
        tick, last = parse_tick(value), row.ticks - 1
    elif kind is LabelKind.SUBTASK:
        name, done = parse_subtask(value)
        tick = done or 0
    else:
        tick = parse_range(value)[1]
    if tick > last:
        raise InvalidInput(
            f"The {kind} {value} was given, and {row.file_path} has {row.ticks} ticks; "
            f"the last that can be said is {last}."
        )
    known = [subtask.name for subtask in row.recorded_task().subtasks] if name else []
    if name and name not in known:
        raise InvalidInput(
            f"The subtask {name[:100]!r} was given; {row.task} has {', '.join(known) or 'none'}."
        )


def kept_text(row: LabelledEpisode) -> str:
    """Return what the edits leave, in a few words; nothing where there are none."""
    return _kept_text(row.edits, row.ticks) if row.edits else ""


def _kept_text(edits: EpisodeEdits, ticks: int) -> str:
    segments = len(edits.runs(ticks))
    return f"{edits.kept(ticks)} of {ticks} ticks, {segments} segment{'s' * (segments != 1)}"
