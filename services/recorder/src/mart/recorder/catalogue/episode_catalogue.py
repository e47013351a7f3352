"""All episodes of a folder at a glance: an SQLite file beside them that is derived and may be deleted at any time.

A row is what the metadata of a file says, under the file's size and modification time; `refresh` reads what is new or
has changed and forgets what is gone. Labels are laid over the rows when they are asked for, and never stored.
"""

from __future__ import annotations

import logging
import sqlite3
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel

from mart.episodes import labels
from mart.episodes.labels import EpisodeLabels
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import MartError
from mart.protocol.recording import SUFFIX

_log = logging.getLogger(__name__)

FILE_NAME = "catalogue.sqlite"
_VERSION = 2  # of Row: another one is thrown away and derived anew
_SCHEMA = "CREATE TABLE episode (path TEXT PRIMARY KEY, size INTEGER, modified_ns INTEGER, row TEXT)"


class LabelledEpisode(BaseModel):
    """One episode in a list. `path` is relative to the catalogue's folder."""

    path: str
    size_bytes: int
    room: str = ""
    number: int = 0
    task: str | None = None
    control_hz: float | None = None
    outcome: str = "unspecified"
    verdict: str = "unverified"
    reason: str = ""
    ticks: int = 0
    simulated_s: float = 0.0
    seed: int | None = None
    mode: str | None = None
    skill: str | None = None
    time_limit_s: float | None = None
    real_time_factor: float | None = None
    missing_ticks: int = 0
    waited_s: float = 0.0
    started_ns: int = 0
    complete: bool = False
    repaired: bool = False
    interrupted: bool = False
    operators: dict[str, str] = {}
    error: str | None = None  # why the file cannot be used
    note: str | None = None
    dropped: bool = False
    datasets: tuple[str, ...] = ()  # that it is part of

    @property
    def arms(self) -> tuple[str, ...]:
        return tuple(sorted(self.operators))

    @property
    def verified(self) -> bool:
        return self.verdict == "verified"

    def labelled(self, said: EpisodeLabels) -> LabelledEpisode:
        changes = {
            "outcome": said.outcome or self.outcome,
            "verdict": said.verdict or self.verdict,
            "note": said.note,
            "dropped": said.dropped,
            "datasets": tuple(sorted(said.datasets)),
        }
        return self.model_copy(update=changes)


@dataclass(frozen=True)
class _Stamp:
    size: int
    modified_ns: int

    @classmethod
    def of(cls, path: Path) -> _Stamp:
        status = path.stat()
        return cls(status.st_size, status.st_mtime_ns)


class EpisodeCatalogue:
    """The episodes under `root`, by a database of its own. Not for use by two threads at once."""

    def __init__(self, root: Path, database: Path | str) -> None:
        self.root = root
        self._database = _open(database)

    def close(self) -> None:
        self._database.close()

    def refresh(self) -> None:
        """Makes the catalogue agree with the folder."""
        stamps = {path: _Stamp.of(path) for path in self.root.rglob(f"*{SUFFIX}")}
        found = {path.relative_to(self.root).as_posix(): (path, stamp) for path, stamp in stamps.items()}
        with self._database:
            known = {
                p: _Stamp(s, m)
                for p, s, m in self._database.execute("SELECT path, size, modified_ns FROM episode")
            }
            gone = [(path,) for path in known.keys() - found.keys()]
            self._database.executemany("DELETE FROM episode WHERE path = ?", gone)
            for name, (path, stamp) in found.items():
                if known.get(name) != stamp:
                    row = describe(path, self.root).model_dump_json()
                    values = (name, stamp.size, stamp.modified_ns, row)
                    self._database.execute("INSERT OR REPLACE INTO episode VALUES (?, ?, ?, ?)", values)

    def refreshed(self) -> list[LabelledEpisode]:
        self.refresh()
        return self.rows()

    def rows(self) -> list[LabelledEpisode]:
        """Oldest first, with what was said about them afterwards."""
        said = labels.fold(labels.read(self.root))
        texts = self._database.execute("SELECT row FROM episode")
        rows = [LabelledEpisode.model_validate_json(text) for (text,) in texts]
        return sorted((overlaid(row, said) for row in rows), key=lambda row: (row.started_ns, row.path))


def list_folder(root: Path) -> list[LabelledEpisode]:
    """Every episode under `root`, by its catalogue, which is brought up to date first."""
    try:
        with closing(EpisodeCatalogue(root, root / FILE_NAME)) as catalogue:
            return catalogue.refreshed()
    except sqlite3.OperationalError as error:
        _log.info("%s cannot be used (%s); the folder is read anew", root / FILE_NAME, error)
    with closing(EpisodeCatalogue(root, ":memory:")) as catalogue:
        return catalogue.refreshed()


def describe(path: Path, root: Path) -> LabelledEpisode:
    """One file as its metadata describe it; a file that cannot be read says why."""
    row = LabelledEpisode(path=path.relative_to(root).as_posix(), size_bytes=path.stat().st_size)
    try:
        file = EpisodeFile.open(path)
        episode, cadence, operators = file.episode, file.cadence, file.operators
        verdict = file.verification.verdict.value
    except MartError as error:
        return row.model_copy(update={"error": str(error)})
    known = {name: value for name, value in episode if name in LabelledEpisode.model_fields}
    drivers = operators.to_strings()
    return LabelledEpisode.model_validate(
        row.model_dump()
        | known
        | {"verdict": verdict, "operators": drivers, "real_time_factor": cadence.real_time_factor}
        | {"missing_ticks": cadence.missing_ticks, "waited_s": cadence.waited_s}
        | {"simulated_s": episode.ticks / episode.control_hz if episode.control_hz else 0.0}
    )


def overlaid(row: LabelledEpisode, said: dict[str, EpisodeLabels]) -> LabelledEpisode:
    """The row with what was said about its file afterwards."""
    return row.labelled(said[row.path]) if row.path in said else row


def _open(path: Path | str) -> sqlite3.Connection:
    """Of our version, and sound: anything else is derived anew. Raises OperationalError where it cannot be written."""
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
