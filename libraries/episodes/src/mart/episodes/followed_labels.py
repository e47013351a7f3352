"""Follow a file of labels: what was parsed stays parsed, as long as the file still begins with the same bytes.

A folder of 10,000 episodes has tens of thousands of labels, and its catalogue asks for them with every request. The
bytes are read each time and their beginning compared by a checksum, so that a file that somebody has shortened or
edited by hand is parsed anew; only lines that are new are parsed, and only what they speak of is put together again.
"""

from __future__ import annotations

import threading
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from mart.episodes.episode_labels import EpisodeLabels, fold
from mart.episodes.label import Label
from mart.protocol.errors import InvalidInput
from mart.runtime.json_lines import json_object

_MAX_REASON_CHARACTERS = 200


class FollowedLabels:
    """Read one file of labels again and again. For any thread.

    parse: turns the object of a line into a label; None is a line that is no object. Raises ValueError, KeyError or
    InvalidInput for what is none.
    """

    def __init__(self, path: Path, parse: Callable[[Mapping[str, Any] | None], Label]) -> None:
        self._path, self._parse = path, parse
        self._lock = threading.Lock()
        self._forget()

    def read(self) -> tuple[list[Label], dict[str, EpisodeLabels], dict[int, str]]:
        """Return all labels in the order they were given, by path what holds, and why which lines are no labels.

        Where nothing has been said of a file since, what holds of it is the same object as before. Raises OSError.
        """
        with self._lock:
            torn = self._follow()
            labels, folded, unknown = list(self._labels), dict(self._folded), dict(self._unknown)
            if torn.strip():  # it may be whole when it is read next, so nothing of it is kept
                label = self._label(torn, self._lines + 1, unknown)
                if label is not None:
                    labels.append(label)
                    said = [*self._by_path.get(label.path, []), label]
                    folded |= fold(said)
            return labels, folded, unknown

    def _forget(self) -> None:
        self._end, self._checksum, self._lines = 0, 0, 0
        self._labels: list[Label] = []
        self._by_path: dict[str, list[Label]] = {}
        self._folded: dict[str, EpisodeLabels] = {}
        self._unknown: dict[int, str] = {}

    def _follow(self) -> bytes:
        """Parse what is new, and return what stands behind the end of the last line."""
        data = memoryview(self._path.read_bytes() if self._path.exists() else b"")
        if len(data) < self._end or zlib.crc32(data[: self._end]) != self._checksum:
            self._forget()
        *lines, torn = bytes(data[self._end :]).split(b"\n")
        new: set[str] = set()
        for line in lines:
            self._lines += 1
            label = self._label(line, self._lines, self._unknown) if line.strip() else None
            if label is not None:
                self._labels.append(label)
                self._by_path.setdefault(label.path, []).append(label)
                new.add(label.path)
        for path in new:
            self._folded |= fold(self._by_path[path])
        end = len(data) - len(torn)
        self._checksum, self._end = zlib.crc32(data[self._end : end], self._checksum), end
        return torn

    def _label(self, line: bytes, number: int, unknown: dict[int, str]) -> Label | None:
        try:
            return self._parse(json_object(line))
        except (ValueError, KeyError, InvalidInput) as error:
            unknown[number] = str(error)[:_MAX_REASON_CHARACTERS]
            return None
