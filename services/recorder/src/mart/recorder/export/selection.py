"""Choose the episodes of an export and read them: one task, the same arms, in ticks of one control rate."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np

from mart.episodes.arrays import EpisodeData
from mart.episodes.compatibility import require_alike
from mart.episodes.filter import DROPPED, EpisodeFilter
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import Corrupt, InvalidInput, NotFound
from mart.protocol.messages import operator_from_word
from mart.protocol.tasks import Task
from mart.protocol.vocabulary import OperatorKind
from mart.recorder.export.cameras import CameraRequest
from mart.recorder.export.holders import holders_in

# What the numbers in a column of sources mean, by tick and arm.
SOURCES: Mapping[int, str] = {operator_from_word(kind): kind.value for kind in OperatorKind}


@dataclass(frozen=True)
class ExportSelection:
    """Hold episodes of one task and the same arms, the oldest first.

    control_hz: in whose ticks they are written, whatever their own rates are.
    skip_idle_s: leave out every stretch of at least so many seconds in which no arm moves; None: what people cut alone.
    cameras: whose pictures stand beside the numbers. captured: which of them were real ones; the others are drawn anew.
    depth, segmentation: whether drawn pictures come with these, too.
    jobs: how many processes work at it.
    with_names: whether the data set and its card name who drove.
    holders: everybody who held a seat in them; the column `holder` numbers them.
    each: how a writer goes through them, for whoever counts along.
    """

    task: Task
    control_hz: float
    episodes: tuple[LabelledEpisode, ...]
    skip_idle_s: float | None = None
    cameras: tuple[CameraRequest, ...] = ()
    captured: tuple[str, ...] = ()
    depth: bool = False
    segmentation: bool = False
    jobs: int = 1
    with_names: bool = False
    holders: tuple[str, ...] = ()
    each: Callable[[Sequence[LabelledEpisode]], Iterable[LabelledEpisode]] = iter

    def asked(self, file_format: str) -> dict[str, object]:
        """Return what an export of it depends on, for JSON: whoever goes on with one must have asked for the same."""
        return {
            "format": file_format,
            "version": version("mart-recorder"),
            "control_hz": self.control_hz,
            "skip_idle_s": self.skip_idle_s,
            "cameras": [*map(str, self.cameras)],
            "depth": self.depth,
            "segmentation": self.segmentation,
            "with_names": self.with_names,
            "episodes": {str(one.file_path.resolve()): one.model_dump_json() for one in self.episodes},
        }


def choose(
    episodes: Iterable[LabelledEpisode], wanted: EpisodeFilter, control_hz: float | None = None
) -> ExportSelection:
    """Choose what the filter takes, each file once. control_hz: None takes the episodes' own, which must be one.

    Raises InvalidInput where nothing is left or where they do not belong together.
    """
    listed = list({episode.file_path.resolve(): episode for episode in episodes}.values())
    taken = wanted.apply(listed)
    if not taken:
        raise InvalidInput(_why_none(listed))
    taken.sort(key=lambda episode: (episode.started_ns, episode.file_path))
    require_alike(taken, "a file holds one: export each by itself", any_rate=control_hz is not None)
    first = taken[0]
    if first.task is None or first.control_hz is None:
        raise InvalidInput(f"{first.file_path} does not say its task and control rate; leave it out.")
    task = first.recorded_task()
    return ExportSelection(task, control_hz or first.control_hz, tuple(taken), holders=holders_in(taken))


def sound(episodes: Iterable[LabelledEpisode]) -> list[LabelledEpisode]:
    """Read every byte of these episodes, and return them; `error` says of one what is wrong with it."""
    return [_checked(episode) for episode in episodes]


def _checked(episode: LabelledEpisode) -> LabelledEpisode:
    try:
        episode.open().check()
    except (Corrupt, NotFound) as error:
        return episode.model_copy(update={"error": str(error)})
    return episode


def read_segments(
    selection: ExportSelection, episode: LabelledEpisode, *, with_integration_states: bool = True
) -> list[EpisodeData]:
    """Read the segments that are left of an episode, as the task's catalogue entry says, in ticks of the selection.

    Raises Corrupt where the file is damaged, its model included, and InvalidInput, naming it, where it is not whole,
    not finite, was recorded at a lower rate, has nothing left, or an action is outside -1 … 1.
    """
    episode.open().check_model()
    segments = episode.segments(
        selection.task,
        selection.control_hz,
        selection.skip_idle_s,
        with_integration_states=with_integration_states,
    )
    if any((np.abs(segment.actions) > 1.0).any() for segment in segments):
        raise InvalidInput(f"{episode.file_path} cannot be exported: an action is outside -1 … 1.")
    return segments


def _why_none(episodes: Sequence[LabelledEpisode]) -> str:
    if not episodes:
        return "There are no episodes in what was given; name episode files or folders of them."
    kinds = Counter(DROPPED if one.dropped else f"{one.outcome} and {one.verdict}" for one in episodes)
    found = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    return f"None of the episodes that were given is taken ({found}); widen --outcome or --verdict."
