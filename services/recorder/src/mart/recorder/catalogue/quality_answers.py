"""Answer how well episodes were recorded and driven, out of what is known by now. Pure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.quality.comparison import WAYS, By, ComparedGroup, JudgedEpisode, compare
from mart.episodes.quality.outliers import JUDGED, Outlier
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import (
    CatalogueReply,
    CatalogueRequest,
    QualityGroup,
    QualityNumber,
    RecordedEpisode,
)
from mart.recorder.catalogue.listing import episode_message
from mart.recorder.catalogue.quality_measurer import KnownQuality

MAX_GROUPS = 200
MAX_OUTLIERS = 50
MAX_COMPARED = 2000  # the newest: comparing them takes a tenth of a second


def comparison(
    known: KnownQuality, rows: Sequence[LabelledEpisode], asked: CatalogueRequest.CompareQuality
) -> CatalogueReply.QualityComparison:
    """Compare the operators or days of one task. rows: all episodes, the oldest first.

    Raises InvalidInput where it is to be compared by anything else.
    """
    by = _by(asked.by)
    of_task = [
        row for row in reversed(rows) if row.task == asked.task and row.error is None and not row.dropped
    ]
    of_task = of_task[:MAX_COMPARED]
    judged = [known.judged[row.path] for row in of_task if row.path in known.judged]
    groups = compare(judged, by)
    return CatalogueReply.QualityComparison(
        groups=map(_group, groups[-MAX_GROUPS:] if by == "day" else groups[:MAX_GROUPS]),
        measured=sum(row.path in known.judged or row.path in known.errors for row in of_task),
        episodes=len(of_task),
        outliers=[with_outliers(episode_message(one.episode), known) for one in judged if one.outliers][
            :MAX_OUTLIERS
        ],
    )


def details(known: KnownQuality, path: str) -> CatalogueReply.QualityDetails:
    """Tell how well one episode was, beside what is usual for its task."""
    if path in known.errors:
        return CatalogueReply.QualityDetails(error=known.errors[path])
    one = known.judged.get(path)
    if one is None:
        return CatalogueReply.QualityDetails(pending=True)
    compared = max((usual.episodes for usual in one.usual.values()), default=0)
    return CatalogueReply.QualityDetails(numbers=_numbers(one), episodes=compared)


def outlier_texts(known: KnownQuality, path: str) -> list[str]:
    """Return what of an episode is unlike the others, each in a sentence."""
    one = known.judged.get(path)
    return [] if one is None else [_text(outlier) for outlier in one.outliers]


def only_outliers(known: KnownQuality, rows: Iterable[LabelledEpisode]) -> list[LabelledEpisode]:
    """Return those of which something is unlike the others."""
    return [row for row in rows if row.path in known.judged and known.judged[row.path].outliers]


def with_outliers(message: RecordedEpisode, known: KnownQuality) -> RecordedEpisode:
    """Return an episode as it travels, with what of it is unlike the others."""
    message.outliers.extend(outlier_texts(known, message.path))
    return message


def _by(text: str) -> By:
    for way in WAYS:
        if text in (way, ""):
            return way
    raise InvalidInput(
        f"A comparison by {text[:100]!r} was asked for; ask for one by {' or by '.join(WAYS)}."
    )


def _numbers(one: JudgedEpisode) -> list[QualityNumber]:
    far = {(outlier.arm, outlier.name): outlier.why for outlier in one.outliers}
    found = []
    for arm, name, value in one.quality.numbers():
        judged, usual = JUDGED.get(name), one.usual.get((arm, name))
        if judged is None:
            continue
        number = QualityNumber(
            name=name,
            arm=arm,
            title=judged.title,
            unit=judged.unit,
            value=value,
            outlier=far.get((arm, name), ""),
        )
        if usual is not None:
            number.low, number.median, number.high = usual.low, usual.median, usual.high
        found.append(number)
    return found


def _group(group: ComparedGroup) -> QualityGroup:
    numbers = [
        QualityNumber(
            name=name,
            title=JUDGED[name].title,
            unit=JUDGED[name].unit,
            value=found.median,
            low=found.low,
            high=found.high,
        )
        for name, found in group.ranges.items()
    ]
    return QualityGroup(
        name=group.name[:100],
        episodes=group.episodes,
        successes=group.successes,
        outliers=group.outliers,
        numbers=numbers,
    )


def _text(outlier: Outlier) -> str:
    title = JUDGED[outlier.name].title
    return f"{title} of {outlier.arm}: {outlier.why}" if outlier.arm else f"{title}: {outlier.why}"
