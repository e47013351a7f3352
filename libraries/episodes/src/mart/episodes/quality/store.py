"""Keep what was measured of episodes: an SQLite file beside them, derived, which may be deleted at any time.

A measurement holds as long as the file has its size and its time of change, and the episode its edits.
"""

from __future__ import annotations

import contextlib
import logging
import sqlite3
from collections.abc import Iterable, Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.quality.measures import EpisodeQuality
from mart.episodes.quality.measuring import measure
from mart.protocol.errors import MartError

_log = logging.getLogger(__name__)

FILE_NAME = "quality.sqlite"
_VERSION = 2  # of what is measured and how: of another one everything is measured anew
_TABLE = "CREATE TABLE quality (path TEXT PRIMARY KEY, stamp TEXT, row TEXT)"


class MeasuredQuality(BaseModel):
    """Hold what was measured of an episode, or why it could not be (`error`)."""

    model_config = ConfigDict(frozen=True)

    quality: EpisodeQuality | None = None
    error: str = ""


def stamp_of(episode: LabelledEpisode) -> str:
    """Return what changes with a file or its edits; empty where the file is gone."""
    try:
        status = episode.file_path.stat()
    except OSError:
        return ""
    record = (episode.real_time_factor, episode.missing_ticks, episode.missing_commands)
    return f"{status.st_size} {status.st_ctime_ns} {record} {episode.edits}"


def measured(episode: LabelledEpisode) -> MeasuredQuality:
    """Measure an episode; of one that cannot be measured, say why."""
    try:
        return MeasuredQuality(quality=measure(episode))
    except MartError as error:
        return MeasuredQuality(error=str(error))
    except Exception as error:  # noqa: BLE001 - logged whole; one file never keeps others from being measured
        _log.exception("%s could not be measured", episode.file_path)
        return MeasuredQuality(
            error=f"{episode.file_path} cannot be measured: {error}. That it is not told better is a fault of MART's."
        )


class QualityStore:
    """Remember measurements below a folder of episodes, on the disk where it takes them. For one thread."""

    def __init__(self, root: Path) -> None:
        self._database = _open(root / FILE_NAME)

    def close(self) -> None:
        """Close the file."""
        self._database.close()

    def known(self, episode: LabelledEpisode) -> MeasuredQuality | None:
        """Return what was measured of the episode as it is now; None where nothing was."""
        try:
            row = self._database.execute(
                "SELECT stamp, row FROM quality WHERE path = ?", (episode.path,)
            ).fetchone()
            if row is None or row[0] != stamp_of(episode):
                return None
            return MeasuredQuality.model_validate_json(row[1])
        except (sqlite3.Error, ValidationError) as error:
            _log.warning("What was measured of %s is not known any more: %s", episode.path, error)
            return None

    def keep(self, episode: LabelledEpisode, found: MeasuredQuality) -> None:
        """Remember what was measured of an episode."""
        values = (episode.path, stamp_of(episode), found.model_dump_json())
        try:
            with self._database:
                self._database.execute("INSERT OR REPLACE INTO quality VALUES (?, ?, ?)", values)
        except sqlite3.Error as error:
            _log.info("What was measured of %s could not be kept: %s", episode.path, error)

    def get(self, episode: LabelledEpisode) -> MeasuredQuality:
        """Return what is known of an episode, which is measured where nothing is."""
        found = self.known(episode)
        if found is None:
            found = measured(episode)
            self.keep(episode, found)
        return found


def measure_all(episodes: Iterable[LabelledEpisode]) -> Iterator[tuple[LabelledEpisode, MeasuredQuality]]:
    """Iterate over episodes, of any folders, with what is measured of each; what was measured before is remembered."""
    stores: dict[Path, QualityStore] = {}
    try:
        for episode in episodes:
            root = _root(episode)
            if root not in stores:
                stores[root] = QualityStore(root)
            yield episode, stores[root].get(episode)
    finally:
        for store in stores.values():
            store.close()


def _root(episode: LabelledEpisode) -> Path:
    """Return the folder that the episode's `path` is below."""
    return episode.file_path.resolve().parents[len(Path(episode.path).parts) - 1]


def _open(path: Path) -> sqlite3.Connection:
    """Open the file, anew where it is damaged or of another version, and in memory where nothing can be written."""
    try:
        return _connected(path)
    except (
        sqlite3.OperationalError
    ) as error:  # somebody else has it, the disk is full, the folder is not ours
        _log.info("%s cannot be used (%s); nothing that is measured is remembered", path, error)
    except sqlite3.DatabaseError as error:
        _log.warning("%s is damaged (%s) and is derived anew", path, error)
        with contextlib.suppress(OSError, sqlite3.Error):
            path.unlink()
            return _connected(path)
    return _connected(":memory:")


def _connected(place: Path | str) -> sqlite3.Connection:
    database = sqlite3.connect(place, timeout=10.0)
    try:
        return _prepared(database)
    except BaseException:
        database.close()
        raise


def _prepared(database: sqlite3.Connection) -> sqlite3.Connection:
    if database.execute("PRAGMA user_version").fetchone() != (_VERSION,):
        with database:
            database.execute("DROP TABLE IF EXISTS quality")
            database.execute(_TABLE)
            database.execute(f"PRAGMA user_version = {_VERSION}")
    return database
