"""Folders that come to be in one step."""

from __future__ import annotations

from pathlib import Path

from mart.runtime.atomic_directory import write_directory_atomically

FILES = {"record.json": b"{}", "seed-0/weights": b"\x00\x01"}


def contents(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


def test_all_files_are_there_and_nothing_else(tmp_path: Path) -> None:
    write_directory_atomically(tmp_path / "a" / "1", FILES)
    assert contents(tmp_path) == {f"a/1/{name}": content for name, content in FILES.items()}


def test_what_an_earlier_crash_left_is_forgotten(tmp_path: Path) -> None:
    (tmp_path / "1.half").mkdir()
    (tmp_path / "1.half" / "torn").write_bytes(b"half")
    write_directory_atomically(tmp_path / "1", FILES)
    assert contents(tmp_path) == {f"1/{name}": content for name, content in FILES.items()}


def test_a_folder_that_is_there_stays(tmp_path: Path) -> None:
    write_directory_atomically(tmp_path / "1", FILES)
    write_directory_atomically(tmp_path / "1", {"record.json": b"other"})
    assert contents(tmp_path / "1") == FILES
    assert [path.name for path in tmp_path.iterdir()] == ["1"]
