"""Write episodes for viewers of other projects, each into a file of its own that has its name when it is whole."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Conflict, InvalidInput
from mart.recorder.export.foxglove import Shown
from mart.runtime.atomic_file import rename_to_new

WriteView = Callable[[EpisodeFile, Path], Shown]


@dataclass(frozen=True)
class View:
    """Tell of an episode that was written."""

    episode: Path
    path: Path
    shown: Shown


def write_views(episodes: Sequence[LabelledEpisode], out: Path, suffix: str, write: WriteView) -> list[View]:
    """Write one episode to the file `out`, or each into the folder `out`, under its own name.

    Raises Conflict where something is there already, or cannot be written; InvalidInput for several into one file.
    """
    if not episodes:
        raise InvalidInput("There are no episodes in what was given; name episode files or folders of them.")
    if out.suffix == suffix and len(episodes) > 1:
        raise InvalidInput(f"{len(episodes)} episodes were given and {out} is one file; name a folder.")
    paths = [out if out.suffix == suffix else out / f"{one.file_path.stem}{suffix}" for one in episodes]
    taken = [path for path in paths if path.exists()] or [p for p in paths if paths.count(p) > 1]
    if taken:
        raise Conflict(f"{taken[0]} is there already; name another file or folder, or remove it.")
    return [
        View(one.file_path, path, _written(one, path, write))
        for one, path in zip(episodes, paths, strict=True)
    ]


def _written(episode: LabelledEpisode, path: Path, write: WriteView) -> Shown:
    half = path.with_name(path.name + ".half")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        shown = write(episode.open(), half)
        rename_to_new(half, path)
    except OSError as error:
        raise Conflict(f"{path} could not be written: {error}.") from error
    finally:
        half.unlink(missing_ok=True)
    return shown
