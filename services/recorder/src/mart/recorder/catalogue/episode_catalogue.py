"""Keep all episodes of a folder at a glance: an SQLite file beside them, derived, which may be deleted at any time.

A row is what the metadata of a file says, under the file's size and modification time; `refresh` reads what is new or
has changed and forgets what is gone. Labels are laid over the rows when they are asked for, and never stored.
"""

from __future__ import annotations

import logging
import os
import sqlite3
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from mart.episodes import labels
from mart.episodes.folder import described, episode_files
from mart.episodes.labelled_episode import LabelledEpisode, as_utf8, describe
from mart.protocol.recording import SUFFIX

_log = logging.getLogger(__name__)

T = TypeVar("T")
Parsed = dict[str, tuple[int | None, LabelledEpisode]]  # path → checksum of the row, and what it says

FILE_NAME = "catalogue.sqlite"
_AT_ONCE = 250  # files between two commits
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
    def of(cls, path: str) -> _Stamp | None:
        try:
            status = os.stat(path)
        except OSError:  # a link that leads nowhere, for instance: it is looked at each time
            return None
        return cls(status.st_size, status.st_ctime_ns)


class EpisodeCatalogue:
    """List the episodes under `root`, by a database of its own. Not for use by two threads at once.

    parsed: the rows that an earlier one has read, by path, which this one adds to; rows that have not changed are not
    parsed again.
    """

    def __init__(self, root: Path, database: Path | str, parsed: Parsed | None = None) -> None:
        self.root = root
        self._database = _open(database)
        self._parsed: Parsed = {} if parsed is None else parsed

    def close(self) -> None:
        """Close the database."""
        self._database.close()

    def refresh(self, after_some: Callable[[int, int], None] | None = None) -> None:
        """Make the catalogue agree with the folder: read what is new or has changed, forget what is gone.

        after_some: told, each time that some files were read and kept, how many of how many.
        """
        found = {as_utf8(name): path for name, path in _names_below(str(self.root))}
        known = {
            name: _Stamp(size, changed_ns)
            for name, size, changed_ns in self._database.execute("SELECT path, size, changed_ns FROM episode")
        }
        with self._database:
            self._forget(known.keys() - found.keys())
        stamps = {name: _Stamp.of(path) for name, path in found.items()}
        changed = [name for name, stamp in stamps.items() if stamp is None or known.get(name) != stamp]
        for start in range(0, len(changed), _AT_ONCE):
            some = changed[start : start + _AT_ONCE]
            with (
                self._database
            ):  # some at a time: nobody waits long for the file, and a kill keeps what was read
                for name in some:
                    self._read(name, Path(found[name]), stamps[name] or _Stamp(0, 0))
            if after_some is not None:
                after_some(start + len(some), len(changed))

    def rows(self) -> list[LabelledEpisode]:
        """Return what was found when it was last refreshed, the oldest first, without what people have said.

        Raises ValueError where a row is not what was written.
        """
        checksums = dict(self._database.execute("SELECT path, checksum FROM episode").fetchall())
        for name in self._parsed.keys() - checksums.keys():
            del self._parsed[name]
        old = [name for name, checksum in checksums.items() if self._parsed.get(name, (None,))[0] != checksum]
        for name in old:
            wanted = self._database.execute("SELECT row, checksum FROM episode WHERE path = ?", (name,))
            text, checksum = wanted.fetchone() or ("", None)
            self._parsed[name] = (checksum, _row(self.root, name, text, checksum))
        return sorted((row for _, row in self._parsed.values()), key=lambda row: (row.started_ns, row.path))

    def episodes(self) -> list[LabelledEpisode]:
        """Return `rows`, each with its labels of now. Raises Corrupt where those cannot be read."""
        said = labels.read_folded(self.root)
        return [row.with_labels(said.get(row.path)) for row in self.rows()]

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

    def listed(database: Path | str) -> list[LabelledEpisode]:
        with closing(EpisodeCatalogue(root, database)) as catalogue:
            catalogue.refresh()
            return catalogue.episodes()

    return by_catalogue(root, listed)


def by_catalogue(root: Path, ask: Callable[[Path | str], T]) -> T:
    """Return what `ask` answers of the catalogue of `root`, which is made anew where it is damaged.

    Where it cannot be used at all, what is asked is one in memory, so the folder is read anew.
    """
    path = root / FILE_NAME
    for attempt in ("as it is", "anew"):
        try:
            return ask(path)
        except (sqlite3.Error, ValueError, TypeError, AttributeError) as error:
            if isinstance(error, sqlite3.Error) and error.sqlite_errorcode & 0xFF in _IN_THE_WAY:
                _log.info("%s cannot be used (%s); the folder is read anew", path, error)
                break
            _log.warning("%s is damaged (%s) and is derived anew", path, error)
            if attempt == "anew" or not _deleted(path):
                break
    return ask(":memory:")


def list_paths(paths: Iterable[Path]) -> list[LabelledEpisode]:
    """List the episodes of files and folders, in their order. A root of episodes is asked by its catalogue.

    Raises NotFound for a path that is not there.
    """
    found: list[LabelledEpisode] = []
    for path in paths:
        is_root = path.is_dir() and labels.is_root(path)
        found += list_folder(path) if is_root else described(episode_files([path]))
    return found


def _names_below(root: str) -> Iterator[tuple[str, str]]:
    """Yield, of each file below a folder that is named as an episode, its name below it and its path."""
    for place, folders, files in os.walk(root):
        for name in (*files, *folders):
            if name.endswith(SUFFIX):
                path = f"{place}/{name}"
                yield path[len(root) :].lstrip("/"), path


def _row(root: Path, name: str, text: str, checksum: int | None) -> LabelledEpisode:
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
