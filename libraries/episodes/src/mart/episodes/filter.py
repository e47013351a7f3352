"""Choose episodes: the one filter behind lists, the catalogue, data sets, exports, training and reports. Pure."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.vocabulary import EpisodeOutcome, OperatorKind

UNREADABLE = "cannot be read"
DROPPED = "dropped"


@dataclass(frozen=True)
class EpisodeFilter:
    """Say which episodes are wanted. An empty field takes all; of a field with several values, one must hold.

    driven_by: human, policy, script, hold or generated, or somebody's name, who drove any arm at any time.
    operators, names: kinds and names that all who drove must be among.
    unusable: take also what people dropped, and files that cannot be read.

        >>> successes = EpisodeFilter(outcomes=("success",), verdicts=("verified",))
        >>> [episode.path for episode in list_episodes("data/episodes") if successes.takes(episode)]
    """

    tasks: tuple[str, ...] = ()
    outcomes: tuple[str, ...] = ()
    verdicts: tuple[str, ...] = ()
    rooms: tuple[str, ...] = ()
    skills: tuple[str, ...] = ()
    datasets: tuple[str, ...] = ()
    driven_by: str = ""
    operators: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    unusable: bool = False

    def takes(self, episode: LabelledEpisode) -> bool:
        """Tell whether an episode is wanted."""
        return not self.why_not(episode)

    def apply(self, episodes: Iterable[LabelledEpisode]) -> list[LabelledEpisode]:
        """Return those that are wanted, in their order."""
        return [episode for episode in episodes if self.takes(episode)]

    def why_not(self, episode: LabelledEpisode) -> str:
        """Say in a word or two why an episode is not wanted; empty for one that is."""
        if not self.unusable and episode.error is not None:
            return UNREADABLE
        if not self.unusable and episode.dropped:
            return DROPPED
        exact = (
            (self.outcomes, episode.outcome),
            (self.verdicts, episode.verdict),
            (self.tasks, episode.task),
            (self.rooms, episode.room),
            (self.skills, episode.skill),
        )
        for wanted, found in exact:
            if wanted and found not in wanted:
                return found or "not known"
        if self.datasets and not set(self.datasets) & set(episode.datasets):
            return "in no such data set"
        return "" if self._drivers_fit(episode) else "driven by others"

    def _drivers_fit(self, episode: LabelledEpisode) -> bool:
        if not (self.driven_by or self.operators or self.names):
            return True
        shifts = episode.shifts
        by_kind = self.driven_by in tuple(OperatorKind)
        return (
            (
                not self.driven_by
                or any(self.driven_by == (one.operator if by_kind else one.name) for one in shifts)
            )
            and (not self.operators or all(one.operator in self.operators for one in shifts))
            and (not self.names or all(one.name in self.names for one in shifts))
        )


# What can be learned from or reported on: neither dropped nor unreadable, nor ended by "this does not count".
COUNTED = EpisodeFilter(outcomes=(EpisodeOutcome.SUCCESS, EpisodeOutcome.FAILURE, EpisodeOutcome.UNSPECIFIED))
