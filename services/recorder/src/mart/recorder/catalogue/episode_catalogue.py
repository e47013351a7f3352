"""Keep all episodes of a folder at a glance: an SQLite file beside them, derived, which may be deleted at any time.

A row is what the metadata of a file says, under the file's size and modification time; `refresh` reads what is new or
has changed and forgets what is gone. Labels are laid over the rows when they are asked for, and never stored.
"""

from __future__ import annotations

import logging
import sqlite3
from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from mart.episodes import labels
from mart.episodes.folder import described, episode_files
from mart.episodes.labelled_episode import LabelledEpisode, describe
from mart.protocol.recording import SUFFIX

_log = logging.getLogger(__name__)

FILE_NAME = "catalogue.sqlite"
_VERSION = 4  # of what a row holds: another one is thrown away and derived anew
_SCHEMA = "CREATE TABLE episode (path TEXT PRIMARY KEY, size INTEGER, modified_ns INTEGER, row TEXT)"


@dataclass(frozen=True)
class _Stamp:
    size: int
    modified_ns: int

    @classmethod
    def of(cls, path: Path) -> _Stamp:
        status = path.stat()
        return cls(status.st_size, status.st_mtime_ns)


class EpisodeCatalogue:
    """List the episodes under `root`, by a database of its own. Not for use by two threads at once."""

    def __init__(self, root: Path, database: Path | str) -> None:
        self.root = root
        self._database = _open(database)

    def close(self) -> None:
        """Close the database."""
        self._database.close()

    def refresh(self) -> None:
        """Make the catalogue agree with the folder: read what is new or has changed, forget what is gone."""
        found = {path.relative_to(self.root).as_posix(): path for path in self.root.rglob(f"*{SUFFIX}")}
        with self._database:
            known = {
                name: _Stamp(size, modified_ns)
                for name, size, modified_ns in self._database.execute(
                    "SELECT path, size, modified_ns FROM episode"
                )
            }
            gone = [(path,) for path in known.keys() - found.keys()]
            self._database.executemany("DELETE FROM episode WHERE path = ?", gone)
            for name, path in found.items():
                stamp = _Stamp.of(path)
                if known.get(name) != stamp:
                    row = describe(path, name).model_dump_json()
                    values = (name, stamp.size, stamp.modified_ns, row)
                    self._database.execute("INSERT OR REPLACE INTO episode VALUES (?, ?, ?, ?)", values)

    def episodes(self) -> list[LabelledEpisode]:
        """Return what was found when it was last refreshed, the oldest first, each with its labels of now."""
        said = labels.read_folded(self.root)
        texts = self._database.execute("SELECT row FROM episode")
        rows = [LabelledEpisode.model_validate_json(text) for (text,) in texts]
        placed = [row.model_copy(update={"file_path": self.root / row.path}) for row in rows]
        labelled = [row.with_labels(said.get(row.path)) for row in placed]
        return sorted(labelled, key=lambda row: (row.started_ns, row.path))


def list_folder(root: Path) -> list[LabelledEpisode]:
    """List every episode under `root`, by its catalogue, which is brought up to date first."""
    try:
        return _listed(root, root / FILE_NAME)
    except sqlite3.OperationalError as error:
        _log.info("%s cannot be used (%s); the folder is read anew", root / FILE_NAME, error)
    return _listed(root, ":memory:")


def list_paths(paths: Iterable[Path]) -> list[LabelledEpisode]:
    """List the episodes of files and folders, in their order. A root of episodes is asked by its catalogue.

    Raises NotFound for a path that is not there.
    """
    found: list[LabelledEpisode] = []
    for path in paths:
        is_root = path.is_dir() and labels.is_root(path)
        found += list_folder(path) if is_root else described(episode_files([path]))
    return found


def _listed(root: Path, database: Path | str) -> list[LabelledEpisode]:
    with closing(EpisodeCatalogue(root, database)) as catalogue:
        catalogue.refresh()
        return catalogue.episodes()


def _open(path: Path | str) -> sqlite3.Connection:
    """Open a database of our version that is sound: anything else is derived anew.

    Raises OperationalError where it cannot be written.
    """
    database = sqlite3.connect(path, timeout=10.0)
    try:
        return _prepared(database)
    except sqlite3.OperationalError:
        database.close()
        raise
    except sqlite3.DatabaseError as error:
        database.close()
        _log.warning("%s is damaged (%s) and is derived anew", path, error)
        Path(path).unlink()
        return _prepared(sqlite3.connect(path, timeout=10.0))


def _prepared(database: sqlite3.Connection) -> sqlite3.Connection:
    if database.execute("PRAGMA user_version").fetchone() != (_VERSION,):
        with database:
            database.execute("DROP TABLE IF EXISTS episode")
            database.execute(_SCHEMA)
            database.execute(f"PRAGMA user_version = {_VERSION}")
    return database
