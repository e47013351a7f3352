"""Episodes that were read before, by the hashes of file and layout: reading again costs a hash and one small file.

What is in the cache is derived: it can be deleted at any time, and a damaged entry is read anew.
"""

from __future__ import annotations

import hashlib
import logging
from pathlib import Path

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load, save

from mart.episodes.reader import EpisodeFile
from mart.protocol.tasks import Task
from mart.runtime.atomic_file import PUBLIC, write_atomically
from mart.trainer.data.episode import EpisodeArrays, read_episode
from mart.trainer.data.layout import ObservationLayout

_log = logging.getLogger(__name__)

_VERSION = 1  # of EpisodeArrays: another one is read anew


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def read_cached(
    file: EpisodeFile, task: Task, control_hz: float | None, sha256: str, folder: Path | None
) -> EpisodeArrays:
    """Read an episode at a control rate, from the cache where it is there.

    Raises what `read_episode` raises. `control_hz`: None is its own. `folder`: of the cache; None reads the file.
    """
    layout = ObservationLayout.of(task)
    if folder is None:
        return read_episode(file, task, layout, control_hz)
    rate = "" if control_hz is None else f"-{control_hz:g}hz"
    entry = folder / f"{sha256}-{layout.sha256[:16]}{rate}-{_VERSION}.safetensors"
    known = _load(entry)
    if known is not None:
        return known
    episode = read_episode(file, task, layout, control_hz)
    _save(entry, episode)
    return episode


def _load(entry: Path) -> EpisodeArrays | None:
    if not entry.is_file():
        return None
    try:
        return EpisodeArrays(**load(entry.read_bytes()))
    except (SafetensorError, TypeError, OSError) as error:
        _log.warning("%s is damaged (%s) and is made anew", entry, error)
        return None


def _save(entry: Path, episode: EpisodeArrays) -> None:
    """Write an entry. Several trainings may do so at once: each writes a file of its own, and the last one holds."""
    arrays = {name: np.ascontiguousarray(array) for name, array in vars(episode).items()}
    write_atomically(entry, save(arrays), PUBLIC)
