"""Which episodes a question means, and how one travels. Pure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from mart.episodes.datasets import NamedDataSet
from mart.protocol.messages import CatalogueReply, CatalogueRequest, RecordedEpisode
from mart.protocol.messages import NamedDataSet as NamedDataSetMessage
from mart.protocol.recording import OperatorsRecord
from mart.recorder.catalogue.episode_catalogue import LabelledEpisode

DEFAULT_COUNT = 50
MAX_COUNT = 200
MAX_OPERATORS = 200
_WORDS = ("human", "policy", "script", "hold")


def listing(
    rows: Sequence[LabelledEpisode], wanted: CatalogueRequest.List, datasets: Iterable[NamedDataSet] = ()
) -> CatalogueReply.Listing:
    """One page of `rows`, newest first, and what there is to choose from. `rows` are oldest first."""
    matching = [row for row in reversed(rows) if matches(row, wanted)]
    count = min(wanted.count or DEFAULT_COUNT, MAX_COUNT)
    return CatalogueReply.Listing(
        episodes=map(episode_message, matching[wanted.offset : wanted.offset + count]),
        matching=len(matching),
        successes=sum(row.outcome == "success" for row in matching),
        tasks=sorted({row.task for row in rows if row.task}),
        operators=sorted({name for row in rows for name in names_of(row)})[:MAX_OPERATORS],
        datasets=map(dataset_message, datasets),
        skills=sorted({row.skill for row in rows if row.skill}),
    )


def matches(row: LabelledEpisode, wanted: CatalogueRequest.List) -> bool:
    """An operator is asked for by what it is (human, policy, script) or by its name."""
    exact = (
        (wanted.task, row.task),
        (wanted.outcome, row.outcome),
        (wanted.verdict, row.verdict),
        (wanted.room, row.room),
        (wanted.skill, row.skill),
    )
    return (
        all(asked in ("", found) for asked, found in exact)
        and wanted.dataset in ("", *row.datasets)
        and _driven_by(row, wanted.operator)
    )


def names_of(row: LabelledEpisode) -> set[str]:
    """People and policies that drove, by name."""
    return {name for _, name in _drivers(row) if name}


def dataset_message(dataset: NamedDataSet) -> NamedDataSetMessage:
    return NamedDataSetMessage(
        name=dataset.name,
        episodes=len(dataset.episodes),
        sha256=dataset.sha256,
        created_ns=dataset.created_ns,
    )


def episode_message(row: LabelledEpisode) -> RecordedEpisode:
    known = row.model_dump(exclude_none=True)
    return RecordedEpisode(**{name: known[name] for name in known if name in _FIELDS})


_FIELDS = {field.name for field in RecordedEpisode.DESCRIPTOR.fields}


def _driven_by(row: LabelledEpisode, operator: str) -> bool:
    if not operator:
        return True
    by_kind = operator in _WORDS
    return any(operator == (kind if by_kind else name) for kind, name in _drivers(row))


def _drivers(row: LabelledEpisode) -> Iterable[tuple[str, str]]:
    shifts = OperatorsRecord.from_strings(row.operators).shifts.values()
    return [(shift.operator, shift.name) for arm in shifts for shift in arm]
