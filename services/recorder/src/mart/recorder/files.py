"""What is known about the episode files that a command line means."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from mart.episodes import labels
from mart.episodes.paths import episode_files
from mart.recorder.catalogue.episode_catalogue import LabelledEpisode, describe, list_folder, overlaid


def rows(paths: Iterable[Path]) -> list[tuple[Path, LabelledEpisode]]:
    """What is known about each of them. A folder that is the root of its episodes is asked by its catalogue."""
    found: list[tuple[Path, LabelledEpisode]] = []
    for path in paths:
        if path.is_dir() and labels.is_root(path):
            found += [(path / row.path, row) for row in list_folder(path)]
        else:
            found += [(file, row_of(file)) for file in episode_files([path])]
    return found


def row_of(path: Path) -> LabelledEpisode:
    """One file by its metadata, and what was said about it afterwards."""
    root = labels.root_of(path)
    return overlaid(describe(path.resolve(), root), labels.fold(labels.read(root)))
