"""Choose which episodes a training learns from."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from mart.episodes.compatibility import require_alike
from mart.episodes.filter import EpisodeFilter
from mart.episodes.folder import episode_files, list_episodes, readable
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import Corrupt, InvalidInput
from mart.trainer.data.data_spec import Selection


def candidates(paths: Iterable[Path]) -> list[LabelledEpisode]:
    """List what can be chosen from, the oldest first, each file once, by its resolved path.

    A file that cannot be read is left out, and the log says so. Raises NotFound for a path that is not there and
    Corrupt where every file is such a one.
    """
    found = list_episodes(path.resolve() for path in episode_files(paths))
    left = readable(found, ())
    if found and not left:
        raise Corrupt(found[0].error or "")
    return left


def select(
    found: list[LabelledEpisode], selection: Selection, *, any_rate: bool = False
) -> list[LabelledEpisode]:
    """Choose those that the selection takes; `any_rate`: they may be of several control rates.

    Raises InvalidInput where none is left, or where they do not belong together.
    """
    chosen = filter_of(selection).apply(found)[: selection.first]
    chosen = chosen[-selection.last :] if selection.last else chosen
    if not chosen:
        raise InvalidInput(_why_none(found, selection))
    require_alike(chosen, "one model learns from one: give a folder of its own for each", any_rate=any_rate)
    return chosen


def filter_of(selection: Selection) -> EpisodeFilter:
    """Return the filter of a selection, which leaves out what people dropped."""
    return EpisodeFilter(
        outcomes=selection.outcomes,
        verdicts=selection.verdicts,
        operators=selection.operators,
        names=selection.names,
    )


def why_left_out(one: LabelledEpisode, selection: Selection) -> str:
    """Say in a word or two why the selection does not take an episode."""
    return filter_of(selection).why_not(one) or "beyond the number asked for"


def _why_none(found: list[LabelledEpisode], selection: Selection) -> str:
    if not found:
        return "There are no episodes in the data that was given; name folders with .mcap files."
    wanted = {name: value for name, value in selection.model_dump(mode="json").items() if value}
    outcomes = ", ".join(f"{n} {word}" for word, n in Counter(one.outcome for one in found).items())
    verdicts = ", ".join(f"{n} {word}" for word, n in Counter(one.verdict for one in found).items())
    return (
        f"None of {len(found)} episodes ({outcomes}; {verdicts}; {sum(one.dropped for one in found)} dropped) "
        f"is taken by the selection {wanted}; widen it."
    )
