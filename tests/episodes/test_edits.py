"""Edits add up whatever their order, and what they leave is what nobody cut."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes.edits import MAX_TICK, EpisodeEdits
from mart.episodes.label import EDITS, LabelKind
from mart.protocol.errors import InvalidInput

TICKS = 60
_ranges = st.tuples(st.integers(0, TICKS + 5), st.integers(1, 12)).map(lambda one: f"{one[0]}-{sum(one)}")
_said = st.lists(
    st.one_of(
        st.tuples(st.sampled_from([LabelKind.CUT, LabelKind.SKIP]), _ranges),
        st.tuples(st.just(LabelKind.SPLIT), st.integers(1, TICKS + 5).map(str)),
    ),
    max_size=8,
)


def edits_of(said: Sequence[tuple[LabelKind, str]]) -> EpisodeEdits:
    edits = EpisodeEdits()
    for kind, value in said:
        edits = EDITS[kind](edits, value)
    return edits


@given(said=_said, data=st.data())
def test_what_is_left_is_what_nobody_took_out(said: list[tuple[LabelKind, str]], data: st.DataObject) -> None:
    edits = edits_of(said)
    assert edits == edits_of(data.draw(st.permutations(said)))
    assert edits == edits_of([(LabelKind(kind), value) for kind, value in edits.values()])
    segments = edits.runs(TICKS)
    left = [tick for segment in segments for start, end in segment for tick in range(start, end)]
    taken = {tick for start, end in chain(edits.cuts, edits.skips) for tick in range(start, end)}
    assert left == [tick for tick in range(TICKS) if tick not in taken]
    assert edits.kept(TICKS) == len(left)


@given(said=_said)
def test_a_segment_goes_over_skips_alone(said: list[tuple[LabelKind, str]]) -> None:
    edits = edits_of(said)
    skipped = {tick for start, end in edits.skips for tick in range(start, end)}
    for segment in edits.runs(TICKS):
        for (_, end), (start, _) in pairwise(segment):
            assert set(range(end, start)) <= skipped
            assert not any(end < tick < start for tick in edits.splits)


def test_subtasks_and_words() -> None:
    edits = EpisodeEdits().with_subtask("grasp=85").with_subtask("lift=never").with_subtask("grasp=90")
    assert edits.subtasks == {"grasp": 90, "lift": None}
    assert (
        str(edits.with_cut("0-12").with_split("40"))
        == "cut 0-12 split 40 subtask grasp=90 subtask lift=never"
    )
    assert not EpisodeEdits()


@pytest.mark.parametrize(
    "text", ["", "12", "40-12", "12-12", "-1-4", "1.5-3", f"0-{MAX_TICK + 1}", "١-٣", "0-5 "]
)
def test_what_is_no_range_is_refused(text: str) -> None:
    with pytest.raises(InvalidInput, match="12-40"):
        EpisodeEdits().with_cut(text)


@pytest.mark.parametrize("text", ["", "0", "-4", "x", "1.0", "²", str(MAX_TICK + 1)])
def test_what_is_no_tick_is_refused(text: str) -> None:
    with pytest.raises(InvalidInput, match="must be a number from 1"):
        EpisodeEdits().with_split(text)


@pytest.mark.parametrize(
    "text", ["", "grasp", "grasp=", "=4", "gr asp=4", "grasp=always", f"grasp={MAX_TICK + 1}"]
)
def test_what_says_nothing_of_a_subtask_is_refused(text: str) -> None:
    with pytest.raises(InvalidInput, match="grasp=never"):
        EpisodeEdits().with_subtask(text)
