"""Turn the edits of episodes into messages, and messages into edits. Pure."""

from __future__ import annotations

from collections.abc import Iterable

from mart.episodes.edit_acts import EditAct
from mart.episodes.edits import Range
from mart.episodes.label import EDITS, LabelKind
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import CatalogueReply, EpisodeEdits, TickRange, TickTimes
from mart.protocol.messages import Edit as EditMessage
from mart.protocol.messages import EditAct as EditActMessage
from mart.recorder.catalogue.episode_editing import EditedEpisode, Said
from mart.recorder.catalogue.listing import episode_message

MAX_ACTS = 200
MAX_TICK_TIMES = 2000
NEVER = -1


def edited_message(done: EditedEpisode) -> CatalogueReply.Edited:
    """Return an episode as it is now, its edits, and the stamp of what was just done."""
    return CatalogueReply.Edited(
        episode=episode_message(done.episode), edits=edits_message(done), act_ns=done.act_ns
    )


def edits_message(done: EditedEpisode) -> EpisodeEdits:
    """Return the edits of an episode and who said them."""
    edits, ticks = done.episode.edits, done.episode.ticks
    return EpisodeEdits(
        cuts=map(_range, edits.cuts),
        skips=map(_range, edits.skips),
        splits=edits.splits,
        subtasks={name: NEVER if tick is None else tick for name, tick in edits.subtasks.items()},
        kept_ticks=edits.kept(ticks),
        segments=len(edits.runs(ticks)),
        acts=map(_act, done.acts[-MAX_ACTS:]),
    )


def edits_of(given: Iterable[EditMessage]) -> list[Said]:
    """Return edits as labels say them. Raises InvalidInput for a kind that is none."""
    said = []
    for one in given:
        if one.kind not in EDITS:
            raise InvalidInput(f"The edit {one.kind[:100]!r} was given; it must be {', '.join(EDITS)}.")
        said.append((LabelKind(one.kind), one.value))
    return said


def tick_times(seconds: Iterable[float]) -> TickTimes:
    """Return when ticks were, thinned, the last one always among them. seconds: of every tick."""
    known = list(seconds)
    ticks = list(range(0, len(known), -(-len(known) // MAX_TICK_TIMES) or 1))
    if known and ticks[-1] != len(known) - 1:
        ticks.append(len(known) - 1)
    return TickTimes(ticks=ticks, seconds=[known[tick] for tick in ticks])


def _range(given: Range) -> TickRange:
    return TickRange(begin=given[0], end=given[1])


def _act(act: EditAct) -> EditActMessage:
    said = (EditMessage(kind=kind, value=value) for kind, value in act.said)
    return EditActMessage(act_ns=act.at_ns, by=act.by, edits=said)
