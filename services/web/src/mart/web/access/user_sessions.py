"""Who has joined. Sessions are kept in SQLite, so that a restart of this service throws nobody out."""

from __future__ import annotations

import hashlib
import secrets
import sqlite3
from dataclasses import dataclass
from pathlib import Path

from mart.protocol.errors import InvalidInput

SESSION_S = 7 * 24 * 3600.0
MAX_NAME_CHARACTERS = 32
_SCHEMA = """
CREATE TABLE IF NOT EXISTS session (
    id_sha256 BLOB PRIMARY KEY,
    holder_id TEXT NOT NULL,
    name TEXT NOT NULL,
    expires_s REAL NOT NULL
) WITHOUT ROWID
"""


@dataclass(frozen=True)
class User:
    """Somebody who has joined: `holder_id` is what the sim knows a seat's holder by, and others never see it."""

    holder_id: str
    name: str


class UserSessions:
    """The sessions of all users; times are Unix seconds. The file holds only hashes of their ids: it lets nobody in."""

    def __init__(self, path: Path | str) -> None:
        if isinstance(path, Path):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch(mode=0o600)
        self._database = sqlite3.connect(path, isolation_level=None)
        self._database.execute("PRAGMA journal_mode = WAL")
        self._database.execute(_SCHEMA)

    def join(self, name: str, now_s: float, known: User | None = None) -> tuple[str, User]:
        """Return a new session's id and its user; one already `known` keeps the seats and may change the name.

        Raises InvalidInput where the name cannot be used.
        """
        user = User(known.holder_id if known else secrets.token_hex(16), clean_name(name))
        session_id = secrets.token_urlsafe(32)
        self._database.execute("DELETE FROM session WHERE expires_s < ?", (now_s,))
        self._database.execute(
            "INSERT INTO session VALUES (?, ?, ?, ?)",
            (_hash(session_id), user.holder_id, user.name, now_s + SESSION_S),
        )
        return session_id, user

    def find(self, session_id: str, now_s: float) -> User | None:
        """Return the user of a session; None where there is no such session, or it has ended."""
        row = self._database.execute(
            "SELECT holder_id, name FROM session WHERE id_sha256 = ? AND expires_s >= ?",
            (_hash(session_id), now_s),
        ).fetchone()
        return User(*row) if row else None

    def close(self) -> None:
        """Close the database."""
        self._database.close()


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
