"""Read HDF5 that anybody may have written: no link is followed out of the file, and nothing large is believed.

Sizes are looked at before anything is read: of a data set by its shape, of its chunks by theirs, which is what HDF5
unpacks at a time. Raises Corrupt, as a sentence about the file, for all that cannot be used.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import Corrupt, NotFound
from mart.recorder.importing.foreign_episode import MAX_EPISODES, MAX_ROWS, MAX_WIDTH

_MAX_CHUNK_BYTES = 64 * 1024 * 1024
_MAX_ATTRIBUTE_BYTES = 4 * 1024 * 1024
_FILTERS = {
    h5py.h5z.FILTER_DEFLATE,
    h5py.h5z.FILTER_SHUFFLE,
    h5py.h5z.FILTER_FLETCHER32,
    h5py.h5z.FILTER_SCALEOFFSET,
    h5py.h5z.FILTER_LZF,
}
# What h5py raises for what is damaged; KeyError and RuntimeError come from HDF5 itself.
_SYMPTOMS = (
    OSError,
    KeyError,
    RuntimeError,
    ValueError,
    TypeError,
    OverflowError,
    UnicodeDecodeError,
    MemoryError,
)


@contextlib.contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """Open a file for reading. Raises NotFound where none is, Corrupt where it is no HDF5 or is damaged."""
    if not path.is_file():
        raise NotFound(f"There is no file {path}; name an HDF5 file.")
    try:
        file = h5py.File(path, "r")
    except _SYMPTOMS as error:
        raise Corrupt(f"{path} is no HDF5 file, or it is damaged: {error}.") from error
    with file:
        yield file


@contextlib.contextmanager
def reading(what: str) -> Iterator[None]:
    """Turn what h5py raises for damaged data into Corrupt, a sentence about `what`."""
    try:
        yield
    except _SYMPTOMS as error:
        raise Corrupt(f"{what} cannot be read: {error}.") from error


def group(parent: h5py.Group, name: str) -> h5py.Group | None:
    """Return a group below another, None where there is none. Raises Corrupt where it is a link or something else."""
    found = _child(parent, name)
    if found is not None and not isinstance(found, h5py.Group):
        raise Corrupt(f"{name!r} is no group; a group is wanted there.")
    return found


def names(parent: h5py.Group) -> list[str]:
    """Return the names in a group. Raises Corrupt for more than a data set can need."""
    with reading(f"The group {parent.name}"):
        if len(parent) > MAX_EPISODES:
            raise Corrupt(f"{parent.name} holds {len(parent)} things; at most {MAX_EPISODES} are taken.")
        return list(parent)


def rows(
    parent: h5py.Group, name: str, kinds: str = "fiub", budget: Budget | None = None
) -> NDArray[Any] | None:
    """Return a data set whole, None where there is none; its first axis is time.

    kinds: of numpy's types that are taken. Raises Corrupt for any other, for pictures and what is longer than allowed,
    and where the numbers of the episode are more than its budget.
    """
    found = _child(parent, name)
    if found is None:
        return None
    if not isinstance(found, h5py.Dataset):
        raise Corrupt(f"{name!r} is a group; numbers are wanted there.")
    with reading(f"{name!r}"):
        _require_plain(found, name, kinds)
        if budget is not None:
            budget.spend(8 * int(found.size))
        return np.asarray(found[()])


class TooWide(Corrupt):
    """A column is as wide as pictures are."""


class Budget:
    """Count bytes that are read, and stop where they are too many. Raises Corrupt then."""

    def __init__(self, most_bytes: int) -> None:
        self._most, self._spent = most_bytes, 0

    def spend(self, size_bytes: int) -> None:
        """Count so many bytes."""
        self._spent += size_bytes
        if self._spent > self._most:
            raise Corrupt(f"it has more than {self._most >> 20} MiB of numbers, and no more are taken")


def octets(parent: h5py.Group, name: str, most_bytes: int) -> bytes | None:
    """Return a data set of bytes, None where there is none."""
    found = _child(parent, name)
    if found is None:
        return None
    with reading(f"{name!r}"):
        if not isinstance(found, h5py.Dataset) or found.dtype != np.uint8 or found.ndim != 1:
            raise Corrupt(f"{name!r} is not made of bytes.")
        _require_own(found, name)
        if found.size > most_bytes:
            raise Corrupt(f"{name!r} has {found.size} bytes; at most {most_bytes} are taken.")
        return bytes(np.asarray(found[()]).tobytes())


def said(holder: h5py.Group, name: str) -> Any:
    """Return what a JSON attribute says, None where there is none. Raises Corrupt."""
    text = words(holder, name)
    if not text:
        return None
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise Corrupt(f"The attribute {name!r} of {holder.name} is no JSON.") from error


def words(holder: h5py.Group, name: str) -> str:
    """Return a text attribute, empty where there is none. Raises Corrupt for any other type."""
    with reading(f"The attribute {name!r} of {holder.name}"):
        if name not in holder.attrs:
            return ""
        if holder.attrs.get_id(name).get_storage_size() > _MAX_ATTRIBUTE_BYTES:
            raise Corrupt(f"The attribute {name!r} of {holder.name} is too long.")
        value = holder.attrs[name]
    if isinstance(value, bytes):
        value = value.decode(errors="replace")
    if not isinstance(value, str):
        raise Corrupt(f"The attribute {name!r} of {holder.name} is no text.")
    if len(value) > _MAX_ATTRIBUTE_BYTES:
        raise Corrupt(f"The attribute {name!r} of {holder.name} is too long.")
    return value


def _child(parent: h5py.Group, name: str) -> Any:
    """Return what has this name in a group, where it is in the same file and no link leads to it."""
    with reading(f"{name!r}"):
        link = parent.get(name, getlink=True)
        if link is None:
            return None
        if not isinstance(link, h5py.HardLink):
            raise Corrupt(f"{name!r} is a link to elsewhere; links are not followed, copy what it leads to.")
        return parent[name]


def _require_plain(found: h5py.Dataset, name: str, kinds: str) -> None:
    if found.dtype.kind not in kinds:
        raise Corrupt(f"{name!r} is of type {found.dtype}; numbers are wanted there.")
    width = int(np.prod(found.shape[1:], dtype=np.float64))
    if width > MAX_WIDTH:
        raise TooWide(f"{name!r} has {width} numbers a row; at most {MAX_WIDTH} are taken, so no pictures.")
    if found.ndim == 0 or found.ndim > 3:
        raise Corrupt(f"{name!r} has {found.ndim} axes; 1 to 3 are taken, the first of them time.")
    if found.shape[0] > MAX_ROWS:
        raise Corrupt(f"{name!r} has {found.shape[0]} rows; at most {MAX_ROWS} are taken.")
    _require_own(found, name)


def _require_own(found: h5py.Dataset, name: str) -> None:
    """Raise Corrupt where numbers are in another file, or are packed so that they need much memory or a plugin."""
    if found.is_virtual or found.external:
        raise Corrupt(f"{name!r} has its numbers in another file; those are not opened, copy them in.")
    plist = found.id.get_create_plist()
    if (
        found.chunks is not None
        and np.prod(found.chunks, dtype=np.float64) * found.dtype.itemsize > _MAX_CHUNK_BYTES
    ):
        raise Corrupt(f"{name!r} is in chunks of more than {_MAX_CHUNK_BYTES >> 20} MiB; repack it.")
    codes = {plist.get_filter(i)[0] for i in range(plist.get_nfilters())}
    if codes - _FILTERS:
        raise Corrupt(f"{name!r} is packed with a filter that is not known; repack it with gzip.")
