"""Make an export episode by episode, in processes beside each other, so that one that was interrupted goes on.

Everything is made in a folder beside the target, `NAME.half`: a folder for each episode, which has its name when it is
whole, and a file that says what was asked for. What is whole need not be made again.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import multiprocessing
import os
import shutil
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import connection
from pathlib import Path
from typing import Any

from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import Conflict, MartError
from mart.recorder.export.selection import ExportSelection

_ASKED = "asked.json"

PieceWriter = Callable[[ExportSelection, LabelledEpisode, Path], None]


@contextlib.contextmanager
def half_folder(path: Path, asked: Mapping[str, Any]) -> Iterator[Path]:
    """Give the folder in which `path` is made; it is gone when the block is done or an episode cannot be exported.

    Whatever else interrupts the block leaves it there, and the next one that asks for the same goes on in it. Raises
    Conflict where `path` is there, cannot be written, is being written, or was begun otherwise.
    """
    if path.exists():
        raise Conflict(f"{path} is there already; name another one or remove it.")
    half = path.with_name(path.name + ".half")
    try:
        half.mkdir(exist_ok=True)
        with _alone(half):
            _require_same(half, json.loads(json.dumps(asked)))
            try:
                yield half
            except MartError:
                shutil.rmtree(half)
                raise
            shutil.rmtree(half)
    except OSError as error:
        raise Conflict(f"{path} could not be written: {error}.") from error


def write_pieces(selection: ExportSelection, half: Path, write: PieceWriter) -> list[Path]:
    """Have `write` fill a folder for each episode that has none yet, and return all of them in order.

    `write` is a module's function: with more than one job it is called in other processes. Raises what it raises.
    """
    folders = [half / "episodes" / f"{number:06d}" for number in range(len(selection.episodes))]
    folders[0].parent.mkdir(exist_ok=True)
    to_do = [number for number, folder in enumerate(folders) if not folder.exists()]
    alone = replace(selection, each=iter, episodes=())
    jobs = min(selection.jobs, len(to_do))
    with contextlib.ExitStack() as stack:
        pool = stack.enter_context(_processes(jobs)) if jobs > 1 else None
        begun: dict[int, Future[None]] = {}
        if pool is not None:
            for number in to_do:
                arguments = (write, alone, selection.episodes[number], folders[number])
                begun[number] = pool.submit(_write_whole, *arguments)
        for number, episode in enumerate(selection.each(selection.episodes)):
            if number in begun:
                begun[number].result()
            elif not folders[number].exists():
                _write_whole(write, alone, episode, folders[number])
    return folders


def _write_whole(
    write: PieceWriter, selection: ExportSelection, episode: LabelledEpisode, folder: Path
) -> None:
    half = folder.with_name(folder.name + ".half")
    shutil.rmtree(half, ignore_errors=True)
    half.mkdir()
    write(selection, episode, half)
    os.replace(half, folder)


@contextlib.contextmanager
def _processes(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """Start processes anew, not as forks: OpenGL's threads and contexts survive no fork."""
    pool = ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _begin)
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)  # what is in hand is finished, and need not be made again


def _begin() -> None:
    """Leave Ctrl-C to the parent, draw on one core, and end where the parent was killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ.setdefault("LP_NUM_THREADS", "1")  # of Mesa's software drawing
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)


@contextlib.contextmanager
def _alone(half: Path) -> Iterator[None]:
    """Hold the folder for this process. Raises Conflict where another one has it."""
    handle = os.open(half, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise Conflict(
                f"Another process is writing {half}; wait for it, or name another target."
            ) from None
        yield
    finally:
        os.close(handle)


def _require_same(half: Path, asked: Mapping[str, Any]) -> None:
    """Write down what is asked for, or find that the folder was begun for the same. Raises Conflict."""
    path = half / _ASKED
    if not path.exists():
        written = path.with_suffix(".new")
        written.write_text(json.dumps(asked, indent=1))
        os.replace(written, path)
        return
    before = json.loads(path.read_text())
    differing = [name for name in asked if before.get(name) != asked[name]]
    if differing:
        said = ", ".join(
            f"{name} ({_short(before.get(name))}, now {_short(asked[name])})" for name in differing
        )
        raise Conflict(
            f"{half} was begun for another export. What differs: {said}. Ask for the same again, or remove it."
        )


def _short(value: Any) -> str:
    text = f"{len(value)} of them" if isinstance(value, dict) else json.dumps(value)
    return text if len(text) <= 80 else text[:79] + "…"
