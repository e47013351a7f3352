"""Who has joined. Sessions are kept in SQLite, so that a restart of this service throws nobody out."""

from __future__ import annotations

import contextlib
import hashlib
import logging
import secrets
import sqlite3
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from mart.protocol.errors import InvalidInput, Unavailable

_log = logging.getLogger(__name__)

SESSION_S = 7 * 24 * 3600.0
MAX_NAME_CHARACTERS = 32
MAX_SESSIONS = 10_000
_SPECTATOR = "spectator-"  # how their holder ids begin, which nobody chooses
_SCHEMA = """
CREATE TABLE IF NOT EXISTS joined (
    id_sha256 BLOB PRIMARY KEY,
    holder_id TEXT NOT NULL,
    name TEXT NOT NULL,
    expires_s REAL NOT NULL,
    code_digest BLOB NOT NULL
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS passed_course (
    holder_id TEXT PRIMARY KEY,
    seconds REAL NOT NULL,
    tries INTEGER NOT NULL
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS hosting (
    holder_id TEXT PRIMARY KEY,
    code_digest BLOB NOT NULL
) WITHOUT ROWID;
DROP TABLE IF EXISTS session; -- of 0.2.0 and before, which did not say for which join code it was
"""


@dataclass(frozen=True)
class User:
    """Somebody who has joined: `holder_id` is what the sim knows a seat's holder by, and others never see it.

    hosts: whether they gave the host code. passed_course: whether they have passed the practice course.
    """

    holder_id: str
    name: str
    hosts: bool = False
    passed_course: bool = False

    @property
    def only_watches(self) -> bool:
        """Whether they came by the link of spectators, who change nothing."""
        return self.holder_id.startswith(_SPECTATOR)


class UserSessions:
    """The sessions of all users; times are Unix seconds. The file holds only hashes of their ids: it lets nobody in.

    A session is good as long as the join code that it came with is the site's: another code ends them all. So it is
    with who hosts, and the host code.
    """

    def __init__(self, path: Path | str, code_digest: bytes = b"", host_digest: bytes = b"") -> None:
        """Open the sessions at `path`; a file that is none is put aside. The digests: of the site's two codes."""
        self._code_digest, self._host_digest = code_digest, host_digest
        try:
            self._database = _opened(path)
        except sqlite3.DatabaseError:
            if not isinstance(path, Path) or not path.is_file():
                raise
            aside = path.with_suffix(".damaged")
            path.replace(aside)
            _log.warning("%s was damaged and is kept as %s; everybody joins anew.", path, aside.name)
            self._database = _opened(path)
        self._database.execute("DELETE FROM joined WHERE code_digest <> ?", (code_digest,))
        self._database.execute("DELETE FROM hosting WHERE code_digest <> ?", (host_digest,))
        self._forget_those_who_left()

    def join(
        self, name: str, now_s: float, known: User | None = None, *, only_watches: bool = False
    ) -> tuple[str, User]:
        """Return a new session's id and its user; one already `known` keeps the seats and may change the name.

        The session before it ends. Raises InvalidInput where the name cannot be used, Unavailable where the session
        cannot be kept.
        """
        keeps = known is not None and known.only_watches == only_watches
        new_id = f"{_SPECTATOR if only_watches else ''}{secrets.token_hex(16)}"
        same = known if keeps else None
        user = replace(same or User(new_id, ""), name=clean_name(name))
        session_id = secrets.token_urlsafe(32)
        with _told():
            self._database.execute("DELETE FROM joined WHERE expires_s < ?", (now_s,))
            self._database.execute("DELETE FROM joined WHERE holder_id = ?", (user.holder_id,))
            self._database.execute(
                "INSERT INTO joined VALUES (?, ?, ?, ?, ?)",
                (_hash(session_id), user.holder_id, user.name, now_s + SESSION_S, self._code_digest),
            )
            self._database.execute(
                "DELETE FROM joined WHERE id_sha256 IN "
                "(SELECT id_sha256 FROM joined ORDER BY expires_s DESC LIMIT -1 OFFSET ?)",
                (MAX_SESSIONS,),
            )
        return session_id, user

    def find(self, session_id: str, now_s: float) -> User | None:
        """Return the user of a session; None where there is no such session, or it has ended.

        Raises Unavailable where the sessions cannot be read.
        """
        with _told():
            row = self._database.execute(
                "SELECT holder_id, name, holder_id IN (SELECT holder_id FROM hosting), "
                "holder_id IN (SELECT holder_id FROM passed_course) FROM joined "
                "WHERE id_sha256 = ? AND expires_s >= ?",
                (_hash(session_id), now_s),
            ).fetchone()
        return User(row[0], row[1], bool(row[2]), bool(row[3])) if row else None

    def pass_course(self, is_them: Callable[[str], bool], seconds: float, tries: int) -> bool:
        """Keep that somebody has passed the practice course, and how; their best in seconds counts.

        is_them: whether a holder id is theirs. Return whether somebody is known by one. Raises Unavailable as `join`.
        """
        with _told():
            known = (row[0] for row in self._database.execute("SELECT holder_id FROM joined").fetchall())
            holder_id = next(filter(is_them, known), None)
            if holder_id is not None:
                self._database.execute(
                    "INSERT INTO passed_course VALUES (?, ?, ?) ON CONFLICT (holder_id) DO UPDATE "
                    "SET seconds = excluded.seconds, tries = excluded.tries WHERE excluded.seconds < seconds",
                    (holder_id, seconds, tries),
                )
        return holder_id is not None

    def has_passed_course(self, holder_id: str) -> bool:
        """Whether whoever holds seats by this id has passed the practice course. Raises Unavailable as `find`."""
        with _told():
            row = self._database.execute(
                "SELECT 1 FROM passed_course WHERE holder_id = ?", (holder_id,)
            ).fetchone()
        return row is not None

    def find_passed(self, is_them: Callable[[str], bool]) -> User | None:
        """Return who has passed the practice course and is known by a holder id that is theirs; None for nobody.

        Raises Unavailable as `find`.
        """
        with _told():
            passed = self._database.execute(
                "SELECT holder_id, name FROM joined WHERE holder_id IN (SELECT holder_id FROM passed_course)"
            ).fetchall()
        them = next((row for row in passed if is_them(row[0])), None)
        return User(them[0], them[1], passed_course=True) if them else None

    def host(self, user: User) -> User:
        """Let a user who joined host from now on, until they leave; return them so. Raises Unavailable as `join`."""
        with _told():
            self._forget_those_who_left()
            self._database.execute(
                "INSERT OR REPLACE INTO hosting VALUES (?, ?)", (user.holder_id, self._host_digest)
            )
        return replace(user, hosts=True)

    def leave(self, user: User) -> None:
        """End the session of a user."""
        with _told():
            self._database.execute("DELETE FROM joined WHERE holder_id = ?", (user.holder_id,))
            self._forget_those_who_left()

    def _forget_those_who_left(self) -> None:
        """Whoever has no session any more hosts no more, and comes back as somebody else."""
        for table in ("hosting", "passed_course"):
            self._database.execute(
                f"DELETE FROM {table} WHERE holder_id NOT IN (SELECT holder_id FROM joined)"  # noqa: S608 - both are above
            )

    def close(self) -> None:
        """Close the database."""
        self._database.close()


def _opened(path: Path | str) -> sqlite3.Connection:
    if isinstance(path, Path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch(mode=0o600)
    database = sqlite3.connect(path, isolation_level=None)
    try:
        database.execute("PRAGMA journal_mode = WAL")
        database.executescript(_SCHEMA)
        database.execute("SELECT * FROM joined").fetchall()
    except sqlite3.DatabaseError:
        database.close()
        raise
    return database


@contextlib.contextmanager
def _told() -> Iterator[None]:
    try:
        yield
    except sqlite3.Error as error:
        raise Unavailable(
            f"Who has joined cannot be looked up or kept now: {error}. Is the disk full? The log tells more."
        ) from error


def clean_name(given: str) -> str:
    """Return `given` as one line without control characters.

    Raises InvalidInput where nothing is left or it is too long.
    """
    name = " ".join("".join(c if c.isprintable() else " " for c in given).split())
    if not 1 <= len(name) <= MAX_NAME_CHARACTERS:
        raise InvalidInput(f"A name of {len(name)} characters was given; use 1 to {MAX_NAME_CHARACTERS}.")
    return name


def _hash(session_id: str) -> bytes:
    return hashlib.sha256(session_id.encode()).digest()
