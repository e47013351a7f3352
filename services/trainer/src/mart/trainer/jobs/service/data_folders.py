"""Find the folders that trainings may learn from: below the data folder, or named by whoever runs the trainer."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from mart.protocol.errors import InvalidInput
from mart.protocol.plain_text import require_path
from mart.protocol.recording import SUFFIX

MAX_ENTRIES = 100_000  # files and folders that are looked at in one folder; a whole disk has millions


class DataFolders:
    """Know which folders may be asked for. Who asks may be anybody with the join code, so no other is even looked at.

    others: folders outside the data folder that may be asked for by their whole path.
    """

    def __init__(self, data_dir: Path, others: Iterable[Path] = ()) -> None:
        self._data_dir = data_dir
        self._others = tuple(others)

    def find(self, given: str) -> Path:
        """Return the folder `given`, resolved; a relative one is below the data folder. It need not exist.

        Raises InvalidInput for one that may not be asked for, or that is no path.
        """
        require_path("data", given)
        path = (self._data_dir / given).resolve()
        if not any(path.is_relative_to(root) for root in self._roots()):
            raise InvalidInput(
                f"The folder {given[:200]!r} was given; trainings learn from folders below the trainer's data "
                "folder, and from those that MART_DATA_FOLDERS names where the trainer runs."
            )
        return path

    def _roots(self) -> Iterator[Path]:
        """Yield what is allowed, resolved; a link in the data folder was put there by its owner."""
        yield self._data_dir.resolve()
        yield from (folder.resolve() for folder in self._others)
        if self._data_dir.is_dir():
            yield from (
                child.resolve() for child in self._data_dir.iterdir() if child.is_symlink() and child.is_dir()
            )


def episode_files(folder: Path, max_entries: int = MAX_ENTRIES) -> list[Path]:
    """Return the episode files below a folder, sorted; what cannot be read, or goes away meanwhile, is left out.

    Raises InvalidInput where there are more than `max_entries` files and folders: it is none of episodes.
    """
    found: list[Path] = []
    seen = 0
    for place, folders, files in os.walk(folder):
        seen += len(folders) + len(files)
        if seen > max_entries:
            raise InvalidInput(
                f"{folder.name!r} holds more than {max_entries} files and folders; name a folder of episodes."
            )
        found += (Path(place, name) for name in files if name.endswith(SUFFIX))
    return sorted(found)
