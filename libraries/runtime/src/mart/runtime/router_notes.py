"""Note how a router admits its user's other programs, by the address at which it listens, in that user's own folder."""

from __future__ import annotations

import contextlib
import logging
import os
import re
from collections.abc import Iterator
from pathlib import Path

from mart.runtime.atomic_file import write_atomically

_log = logging.getLogger(__name__)


@contextlib.contextmanager
def noted(endpoint: str, content: bytes) -> Iterator[None]:
    """Note `content` for this user's other programs while the block runs; where it cannot be, they look elsewhere.

    content: the router's secret, or the path of the folder with the certificate to show to it.
    """
    path = note_path(endpoint)
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        write_atomically(path, content)
    except OSError as error:
        _log.debug("The router is not noted in %s: %s", path, error)
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            if path.read_bytes() == content:  # else another platform's router is at this address by now
                path.unlink()


def noted_text(endpoint: str) -> str:
    """Return what is noted of the router at `endpoint`; empty where nothing is."""
    try:
        return note_path(endpoint).read_text()
    except (OSError, UnicodeDecodeError):
        return ""


def note_path(endpoint: str) -> Path:
    """Return where a router at `endpoint` is noted."""
    state = os.environ.get("XDG_STATE_HOME") or "~/.local/state"
    return Path(state).expanduser() / "mart" / "routers" / re.sub(r"[^A-Za-z0-9.]+", "-", endpoint)
