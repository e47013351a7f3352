"""A file has a seat's pictures from begin to end, or none of them."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    EpisodePhase,
)
from mart.teleop_gateway.video.recorded_view import RecordedView

RECORDED = (EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_RECORDING)
PHASES: tuple[EpisodePhase, ...] = (
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_RECORDING,
    EPISODE_PHASE_ENDED,
)


def test_what_counts_is_who_draws_when_it_counts_down() -> None:
    view = RecordedView()
    steps = [
        (EPISODE_PHASE_PRACTICE, True),
        (EPISODE_PHASE_COUNTDOWN, True),
        (EPISODE_PHASE_RECORDING, False),  # somebody comes who looks at video
        (EPISODE_PHASE_ENDED, False),
        (EPISODE_PHASE_COUNTDOWN, False),
        (EPISODE_PHASE_RECORDING, True),
    ]
    seen = []
    for phase, all_draw in steps:
        view.see(phase, all_draw=all_draw)
        seen.append("wanted" if view.is_wanted else "left out" if view.is_left_out else "")
    assert seen == ["", "left out", "left out", "", "wanted", "wanted"]


@given(st.lists(st.tuples(st.sampled_from(PHASES), st.booleans()), max_size=20))
def test_it_never_changes_while_an_episode_is_on(steps: list[tuple[EpisodePhase, bool]]) -> None:
    view = RecordedView()
    before: EpisodePhase = EPISODE_PHASE_PRACTICE
    for phase, all_draw in steps:
        wanted = view.is_wanted
        view.see(phase, all_draw=all_draw)
        assert view.is_wanted + view.is_left_out == (phase in RECORDED)
        if before in RECORDED and phase in RECORDED:
            assert view.is_wanted == wanted
        before = phase
