"""Edits, undos and redos in any order do what two stacks do."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes.edit_acts import edit_acts, next_stamp, redoable_ns
from mart.episodes.label import Label, LabelKind

PATH = "2026-09-21/one.mcap"


def said(labels: list[Label], kind: LabelKind, value: str) -> int:
    stamp = next_stamp(labels, now_ns=5)  # a clock that stands still
    labels.append(Label(PATH, kind, value, stamp))
    return stamp


@given(st.lists(st.sampled_from(["edit", "undo", "redo"]), max_size=30))
def test_undo_and_redo_are_two_stacks(words: list[str]) -> None:
    labels: list[Label] = []
    done: list[int] = []
    undone: list[int] = []
    for word in words:
        newest, redoable = [act.at_ns for act in edit_acts(labels)][-1:], redoable_ns(labels)
        assert newest == done[-1:]
        assert (redoable is not None) == bool(undone)
        if word == "edit":
            done.append(said(labels, LabelKind.SPLIT, str(len(labels) + 1)))
            undone.clear()
        elif word == "undo" and done:
            said(labels, LabelKind.UNDO, str(done[-1]))
            undone.append(done.pop())
        elif word == "redo" and undone:
            said(labels, LabelKind.UNDO, str(redoable))
            done.append(undone.pop())
        assert [act.at_ns for act in edit_acts(labels)] == done


@pytest.mark.parametrize("now_ns", [0, 100])
def test_an_act_has_a_stamp_of_its_own(now_ns: int) -> None:
    labels = [Label(PATH, LabelKind.NOTE, "late", 99)]
    assert next_stamp(labels, now_ns) == 100
    assert next_stamp([], now_ns) == now_ns
