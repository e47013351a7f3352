"""Make episode files of what a crash or a bad disk has left: every intact message is kept, nothing is invented.

A leftover (`.part`) becomes an episode with a name of its own; of a finished file that is damaged, what is intact is
written beside it, and the file itself stays as it is. Memory stays at one record, whatever the file. One file never
keeps another from being repaired, and what is not MART's is never renamed.
"""

from __future__ import annotations

import fcntl
import glob
import logging
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from mart.episodes import labels
from mart.episodes.folder import files_below
from mart.episodes.foreign import foreign_kind
from mart.episodes.reader import EpisodeFile
from mart.episodes.scan import BoundedFile
from mart.protocol import clock
from mart.protocol.errors import Corrupt, MartError, NotFound
from mart.protocol.recording import PART_SUFFIX, SUFFIX, EpisodeRecord
from mart.recorder.record.finalize import SavedEpisode, VerifyFile, below, free_path
from mart.recorder.repair.mend import mend
from mart.runtime.atomic_file import rename_to_new

_log = logging.getLogger(__name__)

_MENDING_SUFFIX = ".mcap.mending"
_HOPELESS_SUFFIX = ".mcap.unreadable"
_REPAIRED = ".repaired"


@dataclass(frozen=True)
class RepairResult:
    """Tell what became of one file: an episode, or the reason why there is none.

    needless: nothing had to be done, or nothing of MART's is there to be done; so it is no failure.
    """

    source: Path
    saved: SavedEpisode | None
    detail: str
    needless: bool = False


def repair_paths(
    paths: Iterable[Path], verify: VerifyFile, on_file: Callable[[], None] = lambda: None
) -> Iterator[RepairResult]:
    """Repair files, and all that needs it in folders, finished files too. Raises NotFound for a path that is not there.

    A file that was named itself has a result in any case, one of a folder only where something is amiss.
    on_file: called when one of the files that `file_count` counts is done with.
    """
    for path in paths:
        if path.is_dir():
            yield from repair_all(path, verify, on_file)
            yield from _one_by_one(
                files_below(path), lambda file: _repair_finished(file, verify, named=False), on_file
            )
        elif not os.path.lexists(path):
            raise NotFound(f"There is no {path}; name episode files or folders of them.")
        elif path.name.endswith(PART_SUFFIX):
            yield from _one_by_one(
                [path], lambda part: _repair_part(part, labels.root_of(part), verify), on_file
            )
        else:
            yield from _one_by_one([path], lambda file: _repair_finished(file, verify, named=True), on_file)


def file_count(paths: Iterable[Path]) -> int:
    """Return how many files `repair_paths` looks at."""
    return sum(
        len(files_below(path)) + len(files_below(path, PART_SUFFIX)) if path.is_dir() else 1 for path in paths
    )


def repair_all(
    root: Path, verify: VerifyFile, on_file: Callable[[], None] = lambda: None
) -> Iterator[RepairResult]:
    """Repair every leftover under `root`. Files that a recorder is writing are locked, and left alone."""
    for stale in files_below(root, _MENDING_SUFFIX):
        with _exclusive(stale) as free:
            if free:
                stale.unlink()
    parts = files_below(root, PART_SUFFIX)
    yield from _one_by_one(parts, lambda part: _repair_part(part, root, verify), on_file)


def damage_of(path: Path) -> str:
    """Say what is wrong with the bytes of a finished file; empty where all of it reads, every checksum included."""
    try:
        file = EpisodeFile.open(path)
        file.check()
    except Corrupt as error:
        return str(error)
    return "" if EpisodeRecord.NAME in file.metadata else f"It has no record {EpisodeRecord.NAME}."


def log_repairs(repairs: Iterable[RepairResult], told: dict[Path, str]) -> Iterator[SavedEpisode]:
    """Log what was done and pass on what was saved. told: what was said of files that stay; it is not said again."""
    for repaired in repairs:
        if repaired.saved is not None:
            _log.warning("%s repaired: %s %s", repaired.source, repaired.saved.path, repaired.detail)
            yield repaired.saved
        elif told.get(repaired.source) != repaired.detail:
            told[repaired.source] = repaired.detail
            _log.error("%s could not be repaired. %s", repaired.source, repaired.detail)


def _one_by_one(
    files: Iterable[Path], repair: Callable[[Path], RepairResult | None], on_file: Callable[[], None]
) -> Iterator[RepairResult]:
    for file in files:
        try:
            with _exclusive(file) as free:
                result = repair(file) if free else None
        except (MartError, OSError) as error:
            result = RepairResult(file, None, f"It stays as it is: {error}")
        except Exception as error:  # noqa: BLE001 - logged whole; one file never keeps others from being repaired
            _log.exception("%s could not be repaired", file)
            result = RepairResult(file, None, f"It stays as it is, by a fault of MART's: {error!r}.")
        on_file()
        if result is not None:
            yield result


def _repair_part(part: Path, root: Path, verify: VerifyFile) -> RepairResult | None:
    foreign = _foreign(part)
    if foreign:
        return RepairResult(part, None, f"It {foreign}. It was left alone.", needless=True)
    if any(named.samefile(part) for named in part.parent.glob(f"{glob.escape(_stem(part))}*{SUFFIX}")):
        part.unlink()  # naming it was interrupted: it has both names
        return None
    return _adopt(part, root) or _mend_part(part, root, verify)


def _adopt(part: Path, root: Path) -> RepairResult | None:
    """Name a file that was complete and only lacked its name; None for any other."""
    try:
        file = EpisodeFile.open(part)
        file.check()
        episode, cadence, verification = file.episode, file.cadence, file.verification
    except Corrupt:
        return None
    path = free_path(root, episode)
    path.parent.mkdir(parents=True, exist_ok=True)
    rename_to_new(part, path)
    saved = SavedEpisode(path, episode, cadence, verification, path.stat().st_size)
    return RepairResult(part, saved, "It was complete and only lacked its name.")


def _mend_part(part: Path, root: Path, verify: VerifyFile) -> RepairResult:
    mended = mend(part, part.with_name(_stem(part) + _MENDING_SUFFIX), verify, below(root))
    if mended is None:
        kept = part.with_name(_stem(part) + _HOPELESS_SUFFIX)
        rename_to_new(part, kept)
        return RepairResult(part, None, f"It holds no intact state; kept as {kept}.")
    part.unlink()
    return RepairResult(part, *mended)


def _repair_finished(path: Path, verify: VerifyFile, *, named: bool) -> RepairResult | None:
    foreign = _foreign(path)
    if foreign:
        return RepairResult(path, None, f"It {foreign}. It was left alone.", needless=not named)
    if not damage_of(path):
        return RepairResult(path, None, "It is whole, and stays as it is.", needless=True) if named else None
    target = path.with_name(f"{path.name.removesuffix(SUFFIX)}{_REPAIRED}{SUFFIX}")
    if os.path.lexists(target):
        return RepairResult(path, None, f"It was repaired before, as {target}.", needless=True)
    mending = target.with_name(_stem(target) + _MENDING_SUFFIX)
    mended = mend(path, mending, verify, lambda file, _record: file.move_to(target))
    if mended is None:
        return RepairResult(path, None, "It holds no intact state, so nothing was written.")
    saved, detail = mended
    return RepairResult(path, saved, f"{detail} {_carry_labels(path, saved.path)}")


def _foreign(path: Path) -> str:
    """Say what a file is that is not MART's. A leftover that is empty is: a crash came before its first byte."""
    with BoundedFile(path) as file:
        return "" if file.size == 0 and path.name.endswith(PART_SUFFIX) else foreign_kind(file)


def _stem(path: Path) -> str:
    return path.name.removesuffix(PART_SUFFIX).removesuffix(SUFFIX)


@contextmanager
def _exclusive(path: Path) -> Iterator[bool]:
    """Tell whether nobody is writing this file; if so, nobody else repairs it meanwhile.

    Raises Corrupt where it is no file or cannot be opened.
    """
    with ExitStack() as stack:
        try:
            file = stack.enter_context(BoundedFile(path))
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, NotFound) as error:
            _log.debug("%s is left alone: %s", path, error)
            yield False
        else:
            yield os.fstat(file.fileno()).st_nlink > 0  # 0: somebody has just finished with it


def _carry_labels(source: Path, target: Path) -> str:
    """Let what people said of a file hold for the repaired one, and drop the damaged one; say so in a sentence."""
    try:
        root = labels.root_of(source)
        old, new = (labels.resolved(path).relative_to(root).as_posix() for path in (source, target))
        labels.append(root, labels.carried(labels.read_folded(root).get(old), old, new, clock.wall_ns()))
    except MartError as error:
        return f"Its labels could not be carried over: {error}"
    return "What people said of it holds for the new file; the damaged one is kept, and labelled as dropped."
