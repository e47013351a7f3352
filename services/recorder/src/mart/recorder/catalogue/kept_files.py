"""Keep what was made from episodes and is asked for piece by piece: in nameless files, so that memory stays small."""

from __future__ import annotations

import logging
import tempfile
import weakref
from collections import OrderedDict
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from mart.protocol.errors import Conflict

_log = logging.getLogger(__name__)

_MAX_KEPT = 32
_MAX_KEPT_BYTES = 1024 * 1024 * 1024


class KeptFiles:
    """Hold files that vanish with this process; the one that was asked for longest ago goes first.

    folder: on whose disk they are; where it cannot be written, the system's folder for such files is used.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._kept: OrderedDict[tuple[str, ...], BinaryIO] = OrderedDict()
        weakref.finalize(self, _close, self._kept)

    def piece(
        self, key: tuple[str, ...], make: Callable[[BinaryIO], None], offset: int, size_bytes: int
    ) -> tuple[bytes, int]:
        """Return a piece of the file with this key, made where it is not kept, and the size of the whole.

        Raises what `make` raises, and Conflict where the disk is full.
        """
        try:
            if key not in self._kept:
                self._kept[key] = self._made(make)
            self._kept.move_to_end(key)
            self._bound()
            file = self._kept[key]
            whole_bytes = _size_of(file)
            file.seek(min(offset, whole_bytes))
            return file.read(size_bytes), whole_bytes
        except OSError as error:
            raise Conflict(f"What was asked for could not be made ready: {error.strerror}.") from error

    def _made(self, make: Callable[[BinaryIO], None]) -> BinaryIO:
        file = self._opened()
        try:
            make(file)
        except BaseException:
            file.close()
            raise
        return file

    def _opened(self) -> BinaryIO:
        try:
            return tempfile.TemporaryFile(dir=self._folder)
        except OSError as error:
            _log.info("%s takes no file (%s); the system's folder does", self._folder, error)
            return tempfile.TemporaryFile()

    def _bound(self) -> None:
        while len(self._kept) > 1 and (
            len(self._kept) > _MAX_KEPT or sum(map(_size_of, self._kept.values())) > _MAX_KEPT_BYTES
        ):
            _, oldest = self._kept.popitem(last=False)
            oldest.close()


def _close(kept: OrderedDict[tuple[str, ...], BinaryIO]) -> None:
    while kept:
        kept.popitem()[1].close()


def _size_of(file: BinaryIO) -> int:
    return file.seek(0, 2)
