"""Follow a file of labels: what was parsed stays parsed, as long as the file still begins with the same bytes.

A folder of 10,000 episodes has tens of thousands of labels, and its catalogue asks for them with every request. The
bytes are read each time and their beginning compared by a checksum, so that a file that somebody has shortened or
edited by hand is parsed anew; only lines that are new are parsed, and only what they speak of is put together again.
"""

from __future__ import annotations

import threading
import zlib
from pathlib import Path

from mart.episodes.episode_labels import NOTHING_SAID, EpisodeLabels, fold
from mart.episodes.label import Label, LabelKind
from mart.episodes.label_format import parse
from mart.protocol.errors import InvalidInput

_MAX_REASON_CHARACTERS = 200


class FollowedLabels:
    """Read one file of labels again and again. For any thread."""

    def __init__(self, path: Path) -> None:
        self._path = path
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
                said = _said(torn, self._lines + 1, unknown)
                labels += said
                for path in {label.path for label in said}:
                    of_path = [label for label in said if label.path == path]
                    folded |= fold([*self._by_path.get(path, []), *of_path])
            return labels, folded, unknown

    def stamp_after(self, at_ns: int, paths: set[str]) -> int:
        """Return the stamp of a new act: `at_ns`, or the next that is later than all that was said of these files.

        No other act has it. A torn last line does not count. Raises OSError.
        """
        with self._lock:
            self._follow()
            stamp = max([at_ns, *(self._newest_ns[path] + 1 for path in paths & self._newest_ns.keys())])
            while stamp in self._stamps:
                stamp += 1
            return stamp

    def _forget(self) -> None:
        self._end, self._checksum, self._lines = 0, 0, 0
        self._labels: list[Label] = []
        self._by_path: dict[str, list[Label]] = {}
        self._newest_ns: dict[str, int] = {}
        self._stamps: set[int] = set()
        self._folded: dict[str, EpisodeLabels] = {}
        self._unknown: dict[int, str] = {}

    def _follow(self) -> bytes:
        """Parse what is new, and return what stands behind the end of the last line."""
        data = memoryview(self._path.read_bytes() if self._path.exists() else b"")
        if len(data) < self._end or zlib.crc32(data[: self._end]) != self._checksum:
            self._forget()
        *lines, torn = bytes(data[self._end :]).split(b"\n")
        anew: set[str] = set()
        for line in lines:
            self._lines += 1
            if line.strip():
                self._hear(_said(line, self._lines, self._unknown), anew)
        for path in anew:
            self._folded |= fold(self._by_path[path])
        end = len(data) - len(torn)
        self._checksum, self._end = zlib.crc32(data[self._end : end], self._checksum), end
        return torn

    def _hear(self, said: list[Label], anew: set[str]) -> None:
        """Take in the labels of a line; where one changes more than it says itself, its path is to be folded `anew`.

        Of files of which the same held, the same holds after: as one object, since a line may be about very many.
        """
        after: dict[int, tuple[EpisodeLabels, EpisodeLabels]] = {}  # by the id of what held before
        for label in said:
            path, newest_ns = label.path, self._newest_ns.get(label.path, 0)
            self._by_path.setdefault(path, []).append(label)
            if label.at_ns < newest_ns or label.kind is LabelKind.UNDO or path in anew:
                anew.add(path)
            else:
                before = self._folded.get(path, NOTHING_SAID)
                if id(before) not in after:
                    after[id(before)] = before, before.with_label(label)
                self._folded[path] = after[id(before)][1]
            self._newest_ns[path] = max(newest_ns, label.at_ns)
        self._labels += said
        self._stamps.update(label.at_ns for label in said[:1])


def _said(line: bytes, number: int, unknown: dict[int, str]) -> list[Label]:
    try:
        return parse(line)
    except (ValueError, KeyError, InvalidInput) as error:
        unknown[number] = str(error)[:_MAX_REASON_CHARACTERS]
        return []
