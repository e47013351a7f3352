"""What is asked for piece by piece is made once, on the disk, and bounded."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import pytest

from mart.protocol.errors import Conflict, NotFound
from mart.recorder.catalogue import kept_files
from mart.recorder.catalogue.kept_files import KeptFiles


def writing(data: bytes, made: list[bytes]) -> Callable[[BinaryIO], None]:
    def make(out: BinaryIO) -> None:
        made.append(data)
        out.write(data)

    return make


def test_it_is_made_once_and_given_in_pieces(tmp_path: Path) -> None:
    kept, made = KeptFiles(tmp_path), list[bytes]()
    make = writing(b"0123456789", made)
    assert [kept.piece(("a",), make, at, 4) for at in (0, 4, 8, 99)] == [
        (b"0123", 10),
        (b"4567", 10),
        (b"89", 10),
        (b"", 10),
    ]
    assert len(made) == 1
    assert list(tmp_path.iterdir()) == []


def test_the_oldest_goes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_files, "_MAX_KEPT_BYTES", 25)
    kept, made = KeptFiles(tmp_path), list[bytes]()
    for key in ("a", "b", "a", "c", "a", "b"):
        kept.piece((key,), writing(key.encode() * 10, made), 0, 4)
    assert made == [b"a" * 10, b"b" * 10, b"c" * 10, b"b" * 10]


def test_a_failure_leaves_nothing_and_is_a_sentence(tmp_path: Path) -> None:
    def full(out: BinaryIO) -> None:
        raise OSError(28, "No space left on device")

    def none(out: BinaryIO) -> None:
        raise NotFound("There is none.")

    kept, made = KeptFiles(tmp_path), list[bytes]()
    with pytest.raises(Conflict, match="No space left"):
        kept.piece(("a",), full, 0, 4)
    with pytest.raises(NotFound):
        kept.piece(("a",), none, 0, 4)
    assert kept.piece(("a",), writing(b"there", made), 0, 9) == (b"there", 5)


def test_a_folder_that_cannot_be_written_is_no_hindrance(tmp_path: Path) -> None:
    made: list[bytes] = []
    assert KeptFiles(tmp_path / "gone").piece(("a",), writing(b"there", made), 0, 9) == (b"there", 5)
