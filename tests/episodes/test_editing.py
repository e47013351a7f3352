"""What is left of an edited episode are transitions as they were recorded, in every array alike."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes.arrays import EpisodeData
from mart.episodes.editing import edited
from mart.episodes.edits import EpisodeEdits
from tests.episodes.motions import motion


def transitions(data: EpisodeData) -> list[tuple[int, int, int]]:
    """Which tick each row of actions is of, and those of the observations before and after it."""
    actions = np.rint(data.actions[:, 0, 0] * 1000).astype(int).tolist()
    seen = data.observations["tick"][:, 0].astype(int).tolist()
    return list(zip(actions, seen[:-1], seen[1:], strict=True))


def test_nothing_is_done_to_what_nobody_edited() -> None:
    data = motion(10)
    assert edited(data, EpisodeEdits()) == [data]


def test_a_cut_ends_one_motion_and_begins_another() -> None:
    first, second = edited(motion(10), EpisodeEdits().with_cut("3-6"))
    assert transitions(first) == [(0, 0, 1), (1, 1, 2), (2, 2, 3)]
    assert transitions(second) == [(6, 6, 7), (7, 7, 8), (8, 8, 9), (9, 9, 10)]
    assert not first.success.any()
    assert second.success[-1]


def test_over_a_skip_the_motion_goes_on() -> None:
    (whole,) = edited(motion(6), EpisodeEdits().with_skip("2-4"))
    assert transitions(whole) == [(0, 0, 1), (1, 1, 4), (4, 4, 5), (5, 5, 6)]
    assert whole.ticks.tolist() == [0, 1, 4, 5, 6]


def test_trimmed_ends_leave_one_motion() -> None:
    (left,) = edited(motion(10), EpisodeEdits().with_cut("0-2").with_skip("8-10"))
    assert transitions(left)[0] == (2, 2, 3)
    assert transitions(left)[-1] == (7, 7, 8)


def test_subtasks_are_as_somebody_said() -> None:
    (whole,) = edited(motion(6), EpisodeEdits().with_subtask("grasp=2").with_subtask("lift=never"))
    assert whole.subtasks["grasp"].tolist() == [False, False, True, True, True, True, True]
    assert not whole.subtasks["lift"].any()


def test_all_cut_leaves_nothing() -> None:
    assert edited(motion(6), EpisodeEdits().with_cut("0-6")) == []


@given(cut=st.integers(0, 12), skip=st.integers(0, 12), split=st.integers(1, 14))
def test_every_array_tells_of_the_same_ticks(cut: int, skip: int, split: int) -> None:
    edits = EpisodeEdits().with_cut(f"{cut}-{cut + 3}").with_skip(f"{skip}-{skip + 2}").with_split(str(split))
    for segment in edited(motion(12), edits):
        states = segment.ticks.tolist()
        for name in ("sim_time_s", "sent_ns", "integration_states", "success", "tool_positions_in_base"):
            np.testing.assert_array_equal(getattr(segment, name), getattr(motion(12), name)[states])
        assert (
            len(segment.actions)
            == len(segment.sources)
            == len(segment.engaged)
            == len(segment.held)
            == len(segment.holders)
            == len(states) - 1
            > 0
        )
        assert len(segment.subtasks["grasp"]) == len(states)
