"""Make folders of files in one step: a reader, or a crash, finds all of their files or no folder."""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from pathlib import Path

from mart.runtime.atomic_file import sync_folder

_HALF = ".half"


def write_directory_atomically(path: Path, files: Mapping[str, bytes]) -> None:
    """Make the folder `path` with these files (name below it → content), all on the disk when this returns.

    A folder that is there already stays as it is.
    """
    half = path.with_name(path.name + _HALF)
    shutil.rmtree(half, ignore_errors=True)
    for name, content in files.items():
        file = half / name
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("wb") as opened:
            opened.write(content)
            opened.flush()
            os.fsync(opened.fileno())
    for folder in {half, *((half / name).parent for name in files)}:
        sync_folder(folder)
    if path.exists():
        shutil.rmtree(half)
        return
    half.rename(path)
    sync_folder(path.parent)
