"""Keep what cameras are captured from in files that only their owner reads: addresses may hold passwords.

A command line is seen by everybody on the machine, and stands in the supervisor's file and in logs.
"""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

from mart.protocol.errors import InvalidInput
from mart.runtime.atomic_file import PRIVATE, write_atomically

_FOLDER = "cameras"  # below the folder of what runs


def keep_sources(run_dir: Path, room: str, sources: Mapping[str, str]) -> dict[str, Path | None]:
    """Return by each camera's id the file that holds its source now; None where it is captured elsewhere.

    Raises InvalidInput for what cannot be a source: neither a device, nor a URL, nor a file that is there.
    """
    return {camera: _kept(run_dir / _FOLDER / f"{room}-{camera}", text) for camera, text in sources.items()}


@contextlib.contextmanager
def forgetting_sources(run_dir: Path) -> Iterator[None]:
    """Remove what was kept, once the block is over."""
    try:
        yield
    finally:
        shutil.rmtree(run_dir / _FOLDER, ignore_errors=True)


def _kept(path: Path, text: str) -> Path | None:
    if not text:
        return None
    if text.startswith("@"):
        return _there(Path(text[1:]))
    is_file = "://" not in text and not text.isdigit() and not text.startswith("/dev/")
    write_atomically(path, (str(_there(Path(text))) if is_file else text).encode(), PRIVATE)
    return path.resolve()


def _there(path: Path) -> Path:
    if not path.is_file():
        raise InvalidInput(
            f"The camera's source {path.name!r} is no device, no URL and no file that is there."
        )
    return path.resolve()
