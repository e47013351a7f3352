"""Choose the episodes that are multiplied, and read them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mart.episodes.compatibility import require_alike
from mart.episodes.filter import EpisodeFilter
from mart.episodes.folder import list_episodes, readable
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import Task
from mart.protocol.vocabulary import GOOD_VERDICTS, EpisodeOutcome, OperatorKind
from mart.recorder.multiply.demonstration import Demonstration, demonstration_of
from mart.recorder.multiply.segments import segments_of

_MOST = 1000


@dataclass(frozen=True)
class Sources:
    """Hold what is multiplied: demonstrations of one task at one rate."""

    task: Task
    control_hz: float
    demonstrations: tuple[Demonstration, ...]


def read_sources(
    paths: Sequence[Path], task: str, first: int | None, *, from_generated: bool, operator: str = ""
) -> Sources:
    """Read the successful episodes of a task, the oldest first. first: how many of them at most.

    Raises InvalidInput where none is left, where arms or rates differ, where generated ones are among them though they
    are not wanted, and for an episode in which nothing happens that it could be cut at.
    """
    found = readable(list_episodes(paths), paths)
    chosen = EpisodeFilter(
        tasks=(task,),
        outcomes=(EpisodeOutcome.SUCCESS,),
        verdicts=GOOD_VERDICTS,
        driven_by=operator,
    ).apply(found)
    _require_some(found, chosen, task)
    if not from_generated:
        _require_recorded(chosen)
    require_alike(chosen, "give a folder of its own for each")
    chosen = chosen[: min(first or _MOST, _MOST)]
    known = chosen[0].recorded_task()
    demonstrations = tuple(_read(episode, known) for episode in chosen)
    return Sources(known, chosen[0].control_hz or 0.0, demonstrations)


def _read(episode: LabelledEpisode, task: Task) -> Demonstration:
    parts = episode.segments(task)
    if len(parts) != 1:
        raise InvalidInput(
            f"{episode.file_path} was split into {len(parts)} by edits, and a way is carried as one: undo the "
            "split, or drop the episode."
        )
    one = demonstration_of(parts[0], task, episode.file_path.name.replace(",", "_"))
    if all(len(segments_of(task, one, arm)) < 2 for arm in task.arm_names):
        raise InvalidInput(
            f"{episode.file_path} cannot be cut: no gripper opens or closes in it, and no subtask comes to be done. "
            "Drop it, or choose others."
        )
    return one


def _require_some(found: Iterable[LabelledEpisode], chosen: Sequence[LabelledEpisode], task: str) -> None:
    if not chosen:
        of_task = [one for one in found if one.task == task]
        done = sum(one.outcome == EpisodeOutcome.SUCCESS for one in of_task)
        raise InvalidInput(
            f"No episode to multiply: {len(of_task)} of {task} were found, {done} of them successful; it takes "
            "successful ones that are verified."
        )


def _require_recorded(chosen: Iterable[LabelledEpisode]) -> None:
    made = [one for one in chosen if any(s.operator == OperatorKind.GENERATED for s in one.shifts)]
    if made:
        raise InvalidInput(
            f"{len(made)} generated episodes are among those to multiply, such as {made[0].file_path}: their errors "
            "would be multiplied, too. Name other folders, or allow them with --from-generated."
        )
