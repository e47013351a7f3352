"""Whatever happens to the file of labels, what is followed says what reading it anew says."""

from __future__ import annotations

import tempfile
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from mart.episodes import labels
from mart.episodes.episode_labels import fold
from mart.episodes.label import Label, LabelKind
from mart.episodes.label_format import labels_of, lines_of

_ABOUT_SEVERAL = [Label(path, LabelKind.JOIN, "good", 2) for path in "acb"]
LINES = [
    line + b"\n"
    for said in (
        *(
            [Label(path, LabelKind.NOTE, note, at_ns)]
            for path, note, at_ns in (("a", "one", 1), ("a", "two", 2), ("b", "six", 3), ("b", "old", 1))
        ),
        _ABOUT_SEVERAL,
        [Label(path, LabelKind.LEAVE, "good", 4) for path in "ab"],
        [Label("a", LabelKind.UNDO, "2", 5)],
    )
    for line in lines_of(said)
] + [b"\n", b"no label\n", b'{"at_ns":1}\n', b'{"at_ns":5,"path":"c","kin']


@given(
    st.lists(st.lists(st.sampled_from(LINES), max_size=6).map(b"".join), min_size=1, max_size=6), st.data()
)
def test_a_file_that_grows_shrinks_or_is_edited_is_read_as_if_anew(
    contents: list[bytes], data: st.DataObject
) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path, before = Path(folder) / labels.FILE_NAME, b""
        for content in contents:
            before = before + content if data.draw(st.booleans()) else content
            path.write_bytes(before)
            expected = [label for line in before.split(b"\n") for label in labels_of(line)]
            assert labels.read(Path(folder)) == expected
            assert labels.read_folded(Path(folder)) == fold(expected)


def test_a_file_that_is_deleted_says_nothing(tmp_path: Path) -> None:
    labels.append(tmp_path, [Label("a", LabelKind.NOTE, "one", 1)])
    assert labels.read_folded(tmp_path)["a"].note == "one"
    (tmp_path / labels.FILE_NAME).unlink()
    assert labels.read(tmp_path) == []
