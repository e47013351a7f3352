"""List the episodes of a folder, with what people have said about them, straight from the files.

Nothing is kept between two calls, so what is listed is what is there. The recorder's catalogue tells the same faster.
"""

from __future__ import annotations

import glob
import logging
import os
from collections.abc import Iterable
from pathlib import Path

from mart.episodes import labels
from mart.episodes.filter import EpisodeFilter
from mart.episodes.labelled_episode import LabelledEpisode, describe
from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.recording import SUFFIX

_log = logging.getLogger(__name__)

PathLike = str | os.PathLike[str]


def list_episodes(
    paths: PathLike | Iterable[PathLike], wanted: EpisodeFilter | None = None
) -> list[LabelledEpisode]:
    """List episodes, the oldest first, each once.

    paths: episode files and folders with all that is in them, or one of these.
    wanted: which of them; None lists all, also those that were dropped or cannot be read (`error` says why).
    Raises NotFound for a path that is not there.

        >>> for episode in list_episodes("data/episodes"):
        ...     print(episode.path, episode.outcome)
    """
    given = [paths] if isinstance(paths, (str, os.PathLike)) else paths
    files = {labels.resolved(path): path for path in episode_files(map(Path, given))}
    found = sorted(
        described(files.values()), key=lambda one: (one.started_ns, labels.resolved(one.file_path))
    )
    return found if wanted is None else wanted.apply(found)


def find_episodes(root: PathLike, room: str, number: int) -> list[LabelledEpisode]:
    """Find the files of one episode of a room below a folder of episodes: none as long as it is not saved.

    More than one where the recorder was restarted meanwhile, or where a room of this name has begun anew. Only files
    with such a name are opened, so that it can be asked again and again, however many episodes there are.
    """
    names = Path(root).glob(f"*/{glob.escape(room)}-{number:04}-*{SUFFIX}")
    found = described(sorted(names))
    return [episode for episode in found if (episode.room, episode.number) == (room, number)]


def described(files: Iterable[Path]) -> list[LabelledEpisode]:
    """Describe these files, in their order, each with its labels; files that are gone meanwhile are left out."""
    said: dict[Path, dict[str, labels.EpisodeLabels]] = {}
    found = []
    for file in files:
        root = labels.root_of(file)
        if root not in said:
            said[root] = labels.read_folded(root)
        name = labels.resolved(file).relative_to(root).as_posix()
        try:
            found.append(describe(file, name).with_labels(said[root].get(name)))
        except FileNotFoundError:  # moved or deleted since it was listed
            continue
    return found


def readable(found: Iterable[LabelledEpisode], given: Iterable[PathLike]) -> list[LabelledEpisode]:
    """Return those that can be read, of what was found in the paths that were given.

    A file that cannot be read is in nobody's way: one of a folder is left out, and the log says so in a sentence,
    unless people have dropped it. Raises Corrupt, with the reason, for one that was named itself.
    """
    named = {labels.resolved(path) for path in map(Path, given) if not path.is_dir()}
    left: list[LabelledEpisode] = []
    for episode in found:
        if episode.error is None:
            left.append(episode)
        elif labels.resolved(episode.file_path) in named:
            raise Corrupt(episode.error)
        elif not episode.dropped:
            _log.warning("Left out: %s", episode.error)
    return left


def episode_files(paths: Iterable[Path]) -> list[Path]:
    """Return every episode file among `paths`: files themselves, folders with all that is in them. Raises NotFound."""
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            found += files_below(path)
        elif os.path.lexists(path):
            found.append(path)
        else:
            raise NotFound(f"There is no {path}; name episode files or folders of them.")
    return found


def files_below(folder: Path, suffix: str = SUFFIX) -> list[Path]:
    """Return, sorted, all below a folder that is named as an episode file; what it is shows when it is opened.

    Folders that cannot be read, or go away meanwhile, are passed over; links to folders are not followed.
    """
    found: list[Path] = []
    for place, folders, files in os.walk(folder):
        found += (Path(place, name) for name in (*files, *folders) if name.endswith(suffix))
    return sorted(found)
