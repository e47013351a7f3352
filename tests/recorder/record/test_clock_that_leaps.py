"""A clock that is set while an episode is recorded makes nothing of it longer, shorter or another order."""

from __future__ import annotations

from contextlib import closing
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes.reader import EpisodeFile
from mart.episodes.steady_time import SteadyTime
from mart.protocol import clock
from mart.protocol.messages import CatalogueRequest
from mart.recorder.catalogue.handlers import CatalogueHandlers
from tests.recorder import synthetic
from tests.recorder.record.recording_session import RecordingSession

AN_HOUR_NS = 3600 * 10**9
TICKS, LEAPS_AT = 30, 15


@pytest.mark.parametrize("leap_ns", [AN_HOUR_NS, -AN_HOUR_NS])
def test_an_episode_over_which_the_clock_was_set_is_as_long_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, leap_ns: int
) -> None:
    now_ns = synthetic.wall_ns(0)
    monkeypatch.setattr(clock, "wall_ns", lambda: now_ns)
    with closing(RecordingSession(tmp_path)) as session:
        session.event(synthetic.started())
        for tick, state in enumerate(synthetic.states(TICKS)):
            now_ns = synthetic.wall_ns(tick) + (leap_ns if tick >= LEAPS_AT else 0)
            for name in ("due_ns", "fired_ns", "stepped_ns", "sent_ns"):
                setattr(state.stamps, name, now_ns)
            session.states([state])
        session.event(synthetic.ended(TICKS))
        (saved,) = session.told("episode_saved")
        assert saved.episode_saved.verified

    (path,) = tmp_path.rglob("*.mcap")
    file = EpisodeFile.open(path)
    arrived_ns = [message.arrived_ns for message in file.messages()]
    assert all(before <= after for before, after in pairwise(arrived_ns))
    assert arrived_ns[-1] - arrived_ns[0] < 3e9
    assert file.cadence.wall_s == pytest.approx((TICKS - 1) * 0.05, abs=0.1)
    assert 0 < file.episode.ended_ns - file.episode.started_ns < 3e9
    with closing(CatalogueHandlers(tmp_path / "episodes")) as asked:
        (listed,) = asked.answer(CatalogueRequest(list=CatalogueRequest.List())).listing.episodes
        details = asked.answer(CatalogueRequest(show=CatalogueRequest.Show(path=listed.path))).details
    assert details.wall_s == pytest.approx(TICKS * 0.05, abs=0.1)
    assert list(details.tick_times.seconds) == sorted(details.tick_times.seconds)


@given(
    st.lists(st.integers(0, 5 * 10**9), min_size=1, max_size=20),
    st.lists(st.sampled_from([0, 0, AN_HOUR_NS, -AN_HOUR_NS]), min_size=20, max_size=20),
)
def test_leaps_are_taken_out_and_nothing_else(waits_ns: list[int], leaps_ns: list[int]) -> None:
    true_ns = off_ns = 10 * AN_HOUR_NS * 20
    steady = SteadyTime()
    first = steady.steady_ns(off_ns, true_ns)
    for wait_ns, leap_ns in zip(waits_ns, leaps_ns, strict=False):
        true_ns, off_ns = true_ns + wait_ns, off_ns + wait_ns + leap_ns
        assert steady.steady_ns(off_ns, true_ns) - first == true_ns - 10 * AN_HOUR_NS * 20


@given(st.lists(st.integers(-(10**9), 9 * 10**9), max_size=30))
def test_stamps_that_do_not_leap_stay_as_they_are(steps_ns: list[int]) -> None:
    steady, now_ns = SteadyTime(), 10**18
    for step_ns in steps_ns:
        now_ns += step_ns
        assert steady.steady_ns(now_ns, 0) == now_ns
