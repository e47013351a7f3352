"""Lines of JSON that a crash may tear."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from mart.runtime.json_lines import append_json_line, read_json_lines, read_last_json_line

_ROWS = st.lists(
    st.dictionaries(st.text(), st.one_of(st.integers(), st.text(), st.none()), max_size=3), max_size=4
)


@given(rows=_ROWS)
def test_what_is_appended_is_read(tmp_path_factory: object, rows: list[dict[str, object]]) -> None:
    path = tmp_path_factory.mktemp("lines") / "rows.jsonl"  # type: ignore[attr-defined]  # pytest's own factory
    for row in rows:
        append_json_line(path, row)
    assert [row for _number, row in read_json_lines(path)] == rows


def test_a_torn_line_is_told_and_the_next_one_stands_alone(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    append_json_line(path, {"a": 1})
    with path.open("ab") as file:
        file.write(b'{"b": ')
    append_json_line(path, {"c": 3})
    assert list(read_json_lines(path)) == [(1, {"a": 1}), (2, None), (3, {"c": 3})]


def test_what_is_no_object_is_none(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    path.write_bytes(b"[1]\n\n\xff\n7\n")
    assert list(read_json_lines(path)) == [(1, None), (3, None), (4, None)]


def test_a_file_that_is_not_there_has_no_lines(tmp_path: Path) -> None:
    assert list(read_json_lines(tmp_path / "none.jsonl")) == []


def test_the_last_line_is_the_last_whole_one(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    assert read_last_json_line(path) is None
    for number in range(1000):
        append_json_line(path, {"a": number})
    assert read_last_json_line(path) == {"a": 999}
    with path.open("ab") as file:
        file.write(b'{"b": ')
    assert read_last_json_line(path) == {"a": 999}
    path.write_bytes(b"[1]\n")
    assert read_last_json_line(path) is None
