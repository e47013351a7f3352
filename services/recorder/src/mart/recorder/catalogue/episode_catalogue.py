"""Keep all episodes of a folder at a glance: an SQLite file beside them, derived, which may be deleted at any time.

A row is what the metadata of a file says, under the file's size and modification time; `refresh` reads what is new or
has changed and forgets what is gone. Labels are laid over the rows when they are asked for, and never stored.
"""

from __future__ import annotations

import logging
import sqlite3
import zlib
from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from mart.episodes import labels
from mart.episodes.folder import described, episode_files, files_below
from mart.episodes.labelled_episode import LabelledEpisode, as_utf8, describe

_log = logging.getLogger(__name__)

FILE_NAME = "catalogue.sqlite"
_VERSION = 7  # of what a row holds: another one is thrown away and derived anew
_IN_THE_WAY = (  # no fault of the file: somebody else has it, the disk is full, the folder is not ours
    sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED, sqlite3.SQLITE_READONLY, sqlite3.SQLITE_PERM, sqlite3.SQLITE_IOERR,
    sqlite3.SQLITE_FULL, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_AUTH,
)  # fmt: skip
_SCHEMA = "CREATE TABLE episode (path TEXT PRIMARY KEY, size INTEGER, changed_ns INTEGER, row TEXT, checksum INTEGER)"


@dataclass(frozen=True)
class _Stamp:
    """Tell files apart. changed_ns: also of rights and links, since those decide whether a file can be read."""

    size: int
    changed_ns: int

    @classmethod
    def of(cls, path: Path) -> _Stamp | None:
        try:
            status = path.stat()
        except OSError:  # a link that leads nowhere, for instance: it is looked at each time
            return None
        return cls(status.st_size, status.st_ctime_ns)


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
        found = {as_utf8(path.relative_to(self.root).as_posix()): path for path in files_below(self.root)}
        with self._database:
            known = {
                name: _Stamp(size, changed_ns)
                for name, size, changed_ns in self._database.execute(
                    "SELECT path, size, changed_ns FROM episode"
                )
            }
            self._forget(known.keys() - found.keys())
            for name, path in found.items():
                stamp = _Stamp.of(path)
                if stamp is None or known.get(name) != stamp:
                    self._read(name, path, stamp or _Stamp(0, 0))

    def episodes(self) -> list[LabelledEpisode]:
        """Return what was found when it was last refreshed, the oldest first, each with its labels of now.

        Raises ValueError where a row is not what was written.
        """
        said = labels.read_folded(self.root)
        texts = self._database.execute("SELECT path, row, checksum FROM episode")
        rows = [_row(self.root, *columns) for columns in texts]
        labelled = [row.with_labels(said.get(row.path)) for row in rows]
        return sorted(labelled, key=lambda row: (row.started_ns, row.path))

    def _read(self, name: str, path: Path, stamp: _Stamp) -> None:
        try:
            text = describe(path, name).model_dump_json()
        except FileNotFoundError:  # deleted or moved since it was listed
            self._forget([name])
            return
        values = (name, stamp.size, stamp.changed_ns, text, zlib.crc32(text.encode()))
        self._database.execute("INSERT OR REPLACE INTO episode VALUES (?, ?, ?, ?, ?)", values)

    def _forget(self, names: Iterable[str]) -> None:
        self._database.executemany("DELETE FROM episode WHERE path = ?", [(name,) for name in names])


def list_folder(root: Path) -> list[LabelledEpisode]:
    """List every episode under `root`, by its catalogue, which is brought up to date first.

    A catalogue that is damaged, in whatever way, is made anew. Raises Corrupt where the labels cannot be read.
    """
    path = root / FILE_NAME
    for attempt in ("as it is", "anew"):
        try:
            return _listed(root, path)
        except (sqlite3.Error, ValueError, TypeError, AttributeError) as error:
            if isinstance(error, sqlite3.Error) and error.sqlite_errorcode & 0xFF in _IN_THE_WAY:
                _log.info("%s cannot be used (%s); the folder is read anew", path, error)
                break
            _log.warning("%s is damaged (%s) and is derived anew", path, error)
            if attempt == "anew" or not _deleted(path):
                break
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


def _row(root: Path, name: str, text: str, checksum: int) -> LabelledEpisode:
    if zlib.crc32(text.encode()) != checksum:
        raise ValueError(f"the row of {name} is not what was written")
    return LabelledEpisode.model_validate_json(text).model_copy(update={"file_path": root / name})


def _deleted(path: Path) -> bool:
    """Delete a catalogue, and what a transaction has left beside it; tell whether that was possible."""
    try:
        path.unlink(missing_ok=True)
        path.with_name(f"{path.name}-journal").unlink(missing_ok=True)
    except OSError as error:
        _log.warning("%s cannot be deleted: %s", path, error)
        return False
    return True


def _open(path: Path | str) -> sqlite3.Connection:
    """Open a database of our version. Raises sqlite3.Error where it is damaged or cannot be written."""
    database = sqlite3.connect(path, timeout=10.0)
    try:
        if database.execute("PRAGMA user_version").fetchone() != (_VERSION,):
            with database:
                database.execute("DROP TABLE IF EXISTS episode")
                database.execute(_SCHEMA)
                database.execute(f"PRAGMA user_version = {_VERSION}")
    except BaseException:
        database.close()
        raise
    return database
