"""A full disk is waited for: whatever it takes of each write, and whenever, the file holds what was written."""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes.patient_file import PatientFile, is_for_want_of_room, patiently
from mart.protocol import clock

NO_ROOM = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


class FullDisk:
    """Takes so many bytes of each write; None: there is no room."""

    def __init__(self, file: PatientFile, takes: Iterator[int | None]) -> None:
        self._real, self._takes = file._file, takes
        self.fileno, self.close = self._real.fileno, self._real.close

    def write(self, data: bytearray) -> int:
        takes = next(self._takes, len(data))
        if takes is None:
            raise NO_ROOM
        return self._real.write(bytes(data[:takes])) or 0


@given(
    st.lists(st.binary(min_size=1, max_size=20), max_size=20),
    st.lists(st.one_of(st.none(), st.integers(1, 9)), max_size=40),
)
def test_the_file_holds_what_was_written_in_order(
    tmp_path_factory: pytest.TempPathFactory, pieces: list[bytes], takes: list[int | None]
) -> None:
    path = tmp_path_factory.mktemp("disk") / "file"
    file = PatientFile(path)
    file._file = FullDisk(file, iter(takes))  # type: ignore[assignment]
    for number, piece in enumerate(pieces):
        assert file.write(piece) == len(piece)
        assert file.tell() == sum(map(len, pieces[: number + 1]))
        assert b"".join(pieces).startswith(path.read_bytes())
        assert path.stat().st_size + file.waiting_bytes == file.tell()
    for _ in takes:
        with contextlib.suppress(OSError):
            file.sync()
    file.sync()
    file.close()
    assert path.read_bytes() == b"".join(pieces)


def test_memory_is_bounded(tmp_path: Path) -> None:
    file = PatientFile(tmp_path / "file", most_waiting_bytes=10)
    file._file = FullDisk(file, iter([None] * 5))  # type: ignore[assignment]
    file.write(bytes(6))
    with pytest.raises(OSError, match="No space"):
        file.write(bytes(6))
    file.close()


def test_a_broken_disk_is_not_waited_for(tmp_path: Path) -> None:
    file = PatientFile(tmp_path / "file")
    file.close()
    with pytest.raises(ValueError, match="closed"):
        file.write(b"x")
    assert not is_for_want_of_room(OSError(errno.EIO, "broken"))


def test_patience_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = [0.0]
    monkeypatch.setattr(clock, "monotonic_s", lambda: now_s[0])
    monkeypatch.setattr(clock, "sleep_s", lambda duration_s: now_s.__setitem__(0, now_s[0] + duration_s))
    answers = iter([NO_ROOM, NO_ROOM, None])

    def call() -> str:
        if (error := next(answers, NO_ROOM)) is not None:
            raise error
        return "done"

    assert patiently(call, 20.0) == "done"
    with pytest.raises(OSError, match="No space"):
        patiently(call, 3.0)
    assert now_s[0] == pytest.approx(3.5, abs=0.5)
