"""Which episodes a training learns from."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from mart.episodes import labels
from mart.episodes.compatibility import require_alike
from mart.episodes.folder import episode_files
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import InvalidInput
from mart.protocol.recording import EpisodeRecord, Shift
from mart.trainer.data.data_spec import Selection


@dataclass(frozen=True)
class Candidate:
    """An episode file as it stands now: what it says, and what people have said about it since."""

    file: EpisodeFile
    episode: EpisodeRecord
    outcome: str
    verdict: str
    drivers: tuple[Shift, ...]  # of every arm, in its order
    dropped: bool

    @property
    def path(self) -> Path:
        return self.file.path


def candidates(paths: Iterable[Path]) -> list[Candidate]:
    """Oldest first, each file once. Raises NotFound for a path that is not there and Corrupt for a damaged file."""
    said: dict[Path, dict[str, labels.EpisodeLabels]] = {}
    found = []
    for path in sorted({path.resolve() for path in episode_files(paths)}):
        root = labels.root_of(path)
        if root not in said:
            said[root] = labels.fold(labels.read(root))
        label = said[root].get(path.relative_to(root).as_posix(), labels.EpisodeLabels())
        found.append(_candidate(EpisodeFile.open(path), label))
    return sorted(found, key=lambda one: (one.episode.started_ns, one.path))


def select(found: list[Candidate], selection: Selection) -> list[Candidate]:
    """Those that the selection takes. Raises InvalidInput where none is left, or where they do not belong together."""
    chosen = [one for one in found if not _unwanted(one, selection)]
    chosen = chosen[: selection.first]
    chosen = chosen[-selection.last :] if selection.last else chosen
    if not chosen:
        raise InvalidInput(_why_none(found, selection))
    require_alike(
        (one.episode for one in chosen), "one model learns from one: give a folder of its own for each"
    )
    return chosen


def _candidate(file: EpisodeFile, label: labels.EpisodeLabels) -> Candidate:
    episode = file.episode
    return Candidate(
        file=file,
        episode=episode,
        outcome=label.outcome or episode.outcome,
        verdict=label.verdict or file.verification.verdict.value,
        drivers=tuple(shift for shifts in file.operators.shifts.values() for shift in shifts),
        dropped=label.dropped,
    )


def why_left_out(one: Candidate, selection: Selection) -> str:
    """In a word or two, of one that the selection does not take."""
    return _unwanted(one, selection) or "beyond the number asked for"


def _unwanted(one: Candidate, selection: Selection) -> str:
    """Why not; empty where it is wanted. An empty list of the selection takes all."""
    if one.dropped:
        return "dropped"
    for word, wanted in ((one.outcome, selection.outcomes), (one.verdict, selection.verdicts)):
        if wanted and word not in wanted:
            return word
    who = selection.operators and not all(shift.operator in selection.operators for shift in one.drivers)
    names = selection.names and not all(shift.name in selection.names for shift in one.drivers)
    return "driven by others" if who or names else ""


def _why_none(found: list[Candidate], selection: Selection) -> str:
    if not found:
        return "There are no episodes in the data that was given; name folders with .mcap files."
    wanted = {name: value for name, value in selection.model_dump(mode="json").items() if value}
    outcomes = ", ".join(f"{n} {word}" for word, n in _counts(one.outcome for one in found).items())
    verdicts = ", ".join(f"{n} {word}" for word, n in _counts(one.verdict for one in found).items())
    return (
        f"None of {len(found)} episodes ({outcomes}; {verdicts}; {sum(one.dropped for one in found)} dropped) "
        f"is taken by the selection {wanted}; widen it."
    )


def _counts(words: Iterable[str]) -> dict[str, int]:
    counts: dict[str, int] = {}
    for word in words:
        counts[word] = counts.get(word, 0) + 1
    return counts
