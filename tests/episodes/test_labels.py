"""Labels are appended, never lost, and the newest of a kind holds."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.episodes import labels
from mart.episodes.labels import EpisodeLabels, Label, LabelKind
from mart.protocol.errors import Corrupt, InvalidInput

_notes = st.text(st.characters(exclude_categories=["Cs"]), max_size=50)
_paths = st.sampled_from(["2026-09-21/a.mcap", "2026-09-21/b.mcap"])
_label = st.one_of(
    st.builds(Label, _paths, st.just(LabelKind.NOTE), _notes, st.integers(0, 2**62)),
    st.builds(Label, _paths, st.just(LabelKind.OUTCOME), st.sampled_from(["success", "failure"]), st.just(1)),
    st.builds(Label, _paths, st.just(LabelKind.USE), st.sampled_from(["keep", "drop"]), st.just(1)),
)


@settings(max_examples=40)
@given(st.lists(_label, max_size=8))
def test_labels_read_back(tmp_path_factory: pytest.TempPathFactory, said: list[Label]) -> None:
    root = tmp_path_factory.mktemp("labels")
    stamps = [labels.append(root, [label]) for label in said]
    assert labels.read(root) == [replace(one, at_ns=at_ns) for one, at_ns in zip(said, stamps, strict=True)]
    assert len(set(stamps)) == len(stamps)
    assert all(at_ns >= one.at_ns for one, at_ns in zip(said, stamps, strict=True))


@settings(max_examples=40)
@given(st.lists(st.tuples(_paths, st.integers(-5, 5)), max_size=12))
def test_what_is_said_last_holds_whatever_the_clock_does(
    tmp_path_factory: pytest.TempPathFactory, said: list[tuple[str, int]]
) -> None:
    root, now_ns, model = tmp_path_factory.mktemp("clock"), 50, dict[str, str]()
    for number, (path, hours) in enumerate(said):
        now_ns = max(0, now_ns + hours)
        labels.append(root, [Label(path, LabelKind.NOTE, f"{number}", now_ns)])
        model[path] = f"{number}"
        assert {name: one.note for name, one in labels.read_folded(root).items()} == model


def test_a_label_from_elsewhere_keeps_its_stamp_and_is_not_said_twice(tmp_path: Path) -> None:
    newer, older = Label("a", LabelKind.NOTE, "newer", 9), Label("a", LabelKind.NOTE, "older", 3)
    labels.append(tmp_path, [newer])
    assert labels.append_missing(tmp_path, [older, newer, older]) == 1
    assert labels.append_missing(tmp_path, [older, newer]) == 0
    assert labels.read(tmp_path) == [newer, older]
    assert labels.read_folded(tmp_path)["a"].note == "newer"


def test_an_act_about_many_files_is_few_lines(tmp_path: Path) -> None:
    said = [Label(f"2026-09-21/{number}.mcap", LabelKind.JOIN, "all", 7, by="Ana") for number in range(1200)]
    labels.append(tmp_path, said)
    assert len((tmp_path / labels.FILE_NAME).read_bytes().splitlines()) == 3
    assert labels.read(tmp_path) == said


def test_the_newest_of_a_kind_holds() -> None:
    said = [
        Label("a", LabelKind.OUTCOME, "failure", 1),
        Label("a", LabelKind.NOTE, "slipped", 2),
        Label("a", LabelKind.OUTCOME, "success", 3),
        Label("a", LabelKind.USE, "drop", 4),
        Label("a", LabelKind.USE, "keep", 5),
        Label("b", LabelKind.USE, "drop", 6),
    ]
    assert labels.fold(said) == {
        "a": EpisodeLabels(outcome="success", note="slipped"),
        "b": EpisodeLabels(dropped=True),
    }


def test_a_torn_line_costs_itself_only(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    first, second = Label("a", LabelKind.NOTE, "one", 1), Label("a", LabelKind.NOTE, "two", 2)
    labels.append(tmp_path, [first])
    with (tmp_path / labels.FILE_NAME).open("ab") as file:
        file.write(b'{"at_ns": 5, "path": "a", "ki')
    labels.append(tmp_path, [second])
    assert labels.read(tmp_path) == [first, second]
    assert "line 2" in caplog.text


FOREIGN = [
    '{"at_ns":2,"path":"a","kind":"rating","value":"5"}',  # a kind of another version
    '{"at_ns":2,"path":"a","kind":"outcome","value":"paused"}',  # a value of another version
    '{"at_ns":2,"path":"a","kind":"note"}',
    '{"at_ns":"soon","path":"a","kind":"note","value":"x"}',
    '{"at_ns":1e999,"path":"a","kind":"note","value":"x"}',
    '{"at_ns":-1,"path":"a","kind":"note","value":"x"}',
    '{"at_ns":9223372036854775808,"path":"a","kind":"note","value":"x"}',
    '{"at_ns":%s,"path":"a","kind":"note","value":"x"}' % ("1" * 5000),
    '{"at_ns":2,"path":"a","kind":["note"],"value":"x"}',
    '{"at_ns":2,"path":"a","kind":"note","value":{"x":1}}',
    '{"at_ns":2,"path":"a","kind":"note","value":"\\ud800"}',
    '{"at_ns":2,"path":"\\udcff","kind":"note","value":"x"}',
    '{"at_ns":2,"path":"a\\u0000b","kind":"join","value":"few"}',
    '{"at_ns":2,"path":"../../etc/passwd","kind":"join","value":"few"}',
    '{"at_ns":2,"path":"/etc/passwd","kind":"join","value":"few"}',
    '{"at_ns":2,"paths":[],"kind":"join","value":"few"}',
    '{"at_ns":2,"paths":"ab","kind":"join","value":"few"}',
    '{"at_ns":2,"paths":["a",2],"kind":"join","value":"few"}',
    '{"at_ns":2,"paths":["a","../b"],"kind":"join","value":"few"}',
    '{"at_ns":2,"path":"a","paths":["b"],"kind":"join","value":"few"}',
    '{"at_ns":2,"paths":[%s"a"],"kind":"join","value":"few"}' % ('"a",' * 500),
    "[" * 100_000,
    '{"at_ns":2,"path":"a","kind":"note","value":' * 50_000,
    "\0" * 40,
    "[1, 2]",
    '{"at_ns":1e999,"path":"a","kind":"note","value":"x"}',
    "[" * 100_000,
    "null",
    "\xff\xfe",
]


def test_a_line_of_another_version_is_one_warning_and_stays_as_it_is(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    first, second = Label("a", LabelKind.NOTE, "one", 1), Label("a", LabelKind.OUTCOME, "failure", 3)
    labels.append(tmp_path, [first])
    with (tmp_path / labels.FILE_NAME).open("a", encoding="latin-1") as file:
        file.write("".join(f"{line}\n" for line in FOREIGN))
    before = (tmp_path / labels.FILE_NAME).read_bytes()
    assert [labels.read(tmp_path) for _ in range(3)] == [[first]] * 3
    assert len(caplog.records) == 1
    assert f"line 2 and {len(FOREIGN) - 1} more are" in caplog.text
    labels.append(tmp_path, [second])
    assert labels.read_folded(tmp_path) == {"a": EpisodeLabels(outcome="failure", note="one")}
    assert (tmp_path / labels.FILE_NAME).read_bytes().startswith(before)
    assert len(caplog.records) == 1


def test_labels_that_another_version_wrote_read_back(tmp_path: Path) -> None:
    """With spaces, as `json.dumps` writes by default."""
    line = '{"at_ns": 1, "path": "a", "kind": "outcome", "value": "failure", "detail": "seen"}\n'
    (tmp_path / labels.FILE_NAME).write_text(line)
    assert labels.read(tmp_path) == [Label("a", LabelKind.OUTCOME, "failure", 1, "seen")]


@pytest.mark.parametrize(
    ("kind", "value"), [(LabelKind.OUTCOME, "great"), (LabelKind.USE, "maybe"), (LabelKind.NOTE, "x" * 3000)]
)
def test_a_value_that_the_kind_cannot_have_is_refused(kind: LabelKind, value: str) -> None:
    with pytest.raises(InvalidInput):
        Label("a", kind, value, 1)


def test_labels_lie_beside_the_days(tmp_path: Path) -> None:
    assert labels.root_of(tmp_path / "2026-09-21" / "a.mcap") == tmp_path
    assert labels.root_of(tmp_path / "elsewhere" / "a.mcap") == tmp_path / "elsewhere"


@settings(max_examples=100)
@given(st.binary(max_size=200))
def test_any_bytes_are_labels_or_none(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    root = tmp_path_factory.mktemp("bytes")
    first = Label("a", LabelKind.NOTE, "one", 1)
    labels.append(root, [first])
    with (root / labels.FILE_NAME).open("ab") as file:
        file.write(data)
    at_ns = labels.append(root, [first])
    said = labels.read(root)
    assert (said[0], said[-1]) == (first, replace(first, at_ns=at_ns))


def test_labels_that_cannot_be_read_are_no_labels_that_say_nothing(tmp_path: Path) -> None:
    (tmp_path / labels.FILE_NAME).mkdir()
    with pytest.raises(Corrupt, match=r"labels\.jsonl cannot be read"):
        labels.read(tmp_path)


def test_a_file_whose_name_is_no_text_cannot_be_labelled(tmp_path: Path) -> None:
    path = Path(os.fsdecode(bytes(tmp_path) + b"/caf\xe9.mcap"))
    with pytest.raises(InvalidInput, match="rename the file"):
        labels.say(path, LabelKind.NOTE, "x", 1)


def test_an_act_is_undone_by_its_stamp_and_done_again() -> None:
    said = [
        Label("a", LabelKind.CUT, "0-12", 5),
        Label("a", LabelKind.OUTCOME, "failure", 6),
        Label("a", LabelKind.SKIP, "30-40", 7),
        Label("a", LabelKind.SKIP, "50-60", 7),
        Label("b", LabelKind.SKIP, "50-60", 7),
    ]
    known = labels.fold(said)["a"]
    assert str(known.edits) == "cut 0-12 skip 30-40 skip 50-60"
    undone = [*said, Label("a", LabelKind.UNDO, "7", 8), Label("a", LabelKind.UNDO, "6", 9)]
    assert str(labels.fold(undone)["a"].edits) == "cut 0-12"
    assert labels.fold(undone)["a"].outcome is None
    assert str(labels.fold(undone)["b"].edits) == "skip 50-60"
    again = labels.fold([*undone, Label("a", LabelKind.UNDO, "9", 10)])["a"]
    assert (again.outcome, str(again.edits)) == ("failure", "cut 0-12")


def test_a_copy_in_the_place_of_a_file_is_edited_as_it_was() -> None:
    said = labels.fold(
        [Label("a", LabelKind.CUT, "0-12", 5), Label("a", LabelKind.SUBTASK, "grasp=never", 6)]
    )["a"]
    carried = labels.fold(labels.carried(said, "a", "b", 7))
    assert carried["b"].edits == said.edits
    assert carried["a"].dropped


@pytest.mark.parametrize("value", ["", "x", "8", "9", "-1", "1" * 20])
def test_what_was_not_said_before_cannot_be_undone(value: str) -> None:
    with pytest.raises(InvalidInput, match="the stamp of what was said before"):
        Label("a", LabelKind.UNDO, value, 8)
