"""Episodes that were read before, by the hashes of file and layout: reading again costs a hash and one small file.

What is in the cache is derived: it can be deleted at any time, and a damaged entry is read anew.
"""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load, save

from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.tasks import Task
from mart.runtime.atomic_file import PUBLIC, write_atomically
from mart.trainer.data.episode import EpisodeArrays, read_episode
from mart.trainer.data.layout import ObservationLayout

_log = logging.getLogger(__name__)

_VERSION = 2  # of what an entry holds: another one is read anew


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def read_cached(
    episode: LabelledEpisode,
    task: Task,
    sha256: str,
    folder: Path | None,
    *,
    control_hz: float | None = None,
    skip_idle_s: float | None = None,
) -> list[EpisodeArrays]:
    """Read an episode's segments at a control rate, from the cache where they are there.

    Raises what `read_episode` raises. sha256: of the file. control_hz: None is its own. folder: of the cache; None
    reads the file.
    """
    layout = ObservationLayout.of(task)
    if folder is None:
        return read_episode(episode, task, layout, control_hz, skip_idle_s)
    rate = "" if control_hz is None else f"-{control_hz:g}hz"
    entry = (
        folder / f"{sha256}-{layout.sha256[:16]}{rate}{_edits(episode, skip_idle_s)}-{_VERSION}.safetensors"
    )
    known = _load(entry)
    if known is not None:
        return known
    segments = read_episode(episode, task, layout, control_hz, skip_idle_s)
    _save(entry, segments)
    return segments


def _edits(episode: LabelledEpisode, skip_idle_s: float | None) -> str:
    """Return what tells this version of an episode from the recorded one; empty for that."""
    edits = f"-{hashlib.sha256(str(episode.edits).encode()).hexdigest()[:16]}" if episode.edits else ""
    return edits if skip_idle_s is None else f"{edits}-idle{skip_idle_s:g}"


def _load(entry: Path) -> list[EpisodeArrays] | None:
    if not entry.is_file():
        return None
    try:
        arrays = load(entry.read_bytes())
        cuts = np.cumsum(arrays.pop("lengths"))[:-1]
        return _segments(arrays, cuts)
    except (SafetensorError, TypeError, KeyError, ValueError, OSError) as error:
        _log.warning("%s is damaged (%s) and is made anew", entry, error)
        return None


def _segments(arrays: dict[str, NDArray[Any]], cuts: NDArray[np.int64]) -> list[EpisodeArrays]:
    """Return what `_save` laid one behind another; `cuts`: between which transitions."""
    parts = {
        # Each segment has one observation more than it has transitions.
        name: np.split(values, cuts + np.arange(1, len(cuts) + 1) if name == "observations" else cuts)
        for name, values in arrays.items()
    }
    return [
        EpisodeArrays(**dict(zip(parts, segment, strict=True)))
        for segment in zip(*parts.values(), strict=True)
    ]


def _save(entry: Path, segments: Sequence[EpisodeArrays]) -> None:
    """Write an entry. Several trainings may do so at once: each writes a file of its own, and the last one holds."""
    arrays = {name: np.concatenate([vars(one)[name] for one in segments]) for name in vars(segments[0])}
    arrays["lengths"] = np.array([len(one.actions) for one in segments])
    write_atomically(entry, save(arrays), PUBLIC)
