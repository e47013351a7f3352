"""Keep what a platform writes to the user who runs it: names, notes, video, secrets."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

_OTHERS = 0o077
_PRIVATE_FOLDER = 0o700
_OURS = "secrets"  # a folder with this in it was made by a platform


def keep_private(data_dir: Path) -> None:
    """Make this process's files and folders its user's own from now on, and the data folder of a platform as well.

    A folder that is no platform's stays as it is: it may be anything's, and shared on purpose.
    """
    os.umask(_OTHERS)
    with contextlib.suppress(
        OSError
    ):  # not there yet, or not ours: what is made in it is private all the same
        if (data_dir / _OURS).is_dir() and data_dir.stat().st_mode & _OTHERS:
            data_dir.chmod(_PRIVATE_FOLDER)
