"""Answer which episodes a question means, and turn them into messages. Pure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from mart.episodes.datasets import NamedDataSet
from mart.episodes.filter import EpisodeFilter
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.messages import CatalogueReply, CatalogueRequest, RecordedEpisode
from mart.protocol.messages import NamedDataSet as NamedDataSetMessage
from mart.protocol.vocabulary import EpisodeOutcome

DEFAULT_COUNT = 50
MAX_COUNT = 200
MAX_OPERATORS = 200
_MAX_ARMS = 16
_MAX_TEXT_CHARACTERS = 2000


def listing(
    rows: Sequence[LabelledEpisode], wanted: CatalogueRequest.List, datasets: Iterable[NamedDataSet] = ()
) -> CatalogueReply.Listing:
    """Return one page of what is wanted, newest first, and what there is to choose from. rows: oldest first."""
    matching = [row for row in filter_of(wanted).apply(reversed(rows)) if row.started_ns >= wanted.since_ns]
    count = min(wanted.count or DEFAULT_COUNT, MAX_COUNT)
    return CatalogueReply.Listing(
        episodes=map(episode_message, matching[wanted.offset : wanted.offset + count]),
        matching=len(matching),
        successes=sum(row.outcome == EpisodeOutcome.SUCCESS for row in matching),
        tasks=sorted({row.task for row in rows if row.task}),
        operators=sorted({name for row in rows for name in names_of(row)})[:MAX_OPERATORS],
        datasets=map(dataset_message, datasets),
        skills=sorted({row.skill for row in rows if row.skill}),
        simulated_s=sum(row.simulated_s for row in matching),
        drivers=drivers_of(matching),
    )


def drivers_of(rows: Iterable[LabelledEpisode]) -> list[CatalogueReply.DriverStatistics]:
    """Return what each person and policy that is named has driven in these episodes, by name."""
    by_name: dict[str, list[LabelledEpisode]] = {}
    for row in rows:
        for name in names_of(row):
            by_name.setdefault(name, []).append(row)
    return [
        CatalogueReply.DriverStatistics(
            name=_cut(name),
            episodes=len(driven),
            successes=sum(row.outcome == EpisodeOutcome.SUCCESS for row in driven),
            simulated_s=sum(row.simulated_s for row in driven),
        )
        for name, driven in sorted(by_name.items())[:MAX_OPERATORS]
    ]


def filter_of(wanted: CatalogueRequest.List) -> EpisodeFilter:
    """Return the filter that a question asks for; dropped and unreadable episodes are listed too."""

    def one(word: str) -> tuple[str, ...]:
        return (word,) if word else ()

    return EpisodeFilter(
        tasks=one(wanted.task),
        outcomes=one(wanted.outcome),
        verdicts=one(wanted.verdict),
        rooms=one(wanted.room),
        skills=one(wanted.skill),
        datasets=one(wanted.dataset),
        driven_by=wanted.operator,
        unusable=True,
    )


def _cut(text: str) -> str:
    return text if len(text) <= _MAX_TEXT_CHARACTERS else f"{text[: _MAX_TEXT_CHARACTERS - 1]}…"


def names_of(row: LabelledEpisode) -> set[str]:
    """Return the names of the people and policies that drove."""
    return {shift.name for shift in row.shifts if shift.name}


def dataset_message(dataset: NamedDataSet) -> NamedDataSetMessage:
    """Return a data set as it travels."""
    return NamedDataSetMessage(
        name=dataset.name,
        episodes=len(dataset.episodes),
        sha256=dataset.sha256,
        created_ns=dataset.created_ns,
    )


def episode_message(row: LabelledEpisode) -> RecordedEpisode:
    """Return an episode as it travels; texts are cut, so that a page of strange files stays small."""
    known = row.model_dump(exclude_none=True)
    known["operators"] = {arm: _cut(text) for arm, text in list(row.operators.items())[:_MAX_ARMS]}
    known |= {name: _cut(text) for name, text in known.items() if isinstance(text, str) and name != "path"}
    if row.edits:
        known |= {"kept_ticks": row.edits.kept(row.ticks), "segments": len(row.edits.runs(row.ticks))}
    return RecordedEpisode(**{name: known[name] for name in known if name in _FIELDS})


_FIELDS = {field.name for field in RecordedEpisode.DESCRIPTOR.fields}
