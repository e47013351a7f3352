"""The one filter: what each field takes, and what it says of those that it does not take."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes import COUNTED, EpisodeFilter, EpisodeLabels, LabelledEpisode

EPISODE = LabelledEpisode(
    path="2026-09-21/room-1-0001-lift.mcap",
    size_bytes=1,
    room="room-1",
    number=1,
    task="lift",
    outcome="success",
    verdict="verified",
    skill="novice",
    operators={"arm0": "policy lifter | tick 9: human Ben", "arm1": "script novice"},
    datasets=("few", "good"),
)


@pytest.mark.parametrize(
    ("wanted", "why"),
    [
        (EpisodeFilter(), ""),
        (EpisodeFilter(tasks=("lift", "wipe")), ""),
        (EpisodeFilter(tasks=("wipe",)), "lift"),
        (EpisodeFilter(outcomes=("failure",)), "success"),
        (EpisodeFilter(verdicts=("unverified",)), "verified"),
        (EpisodeFilter(rooms=("room-2",)), "room-1"),
        (EpisodeFilter(skills=("expert",)), "novice"),
        (EpisodeFilter(datasets=("good", "other")), ""),
        (EpisodeFilter(datasets=("goo",)), "in no such data set"),
        (EpisodeFilter(driven_by="human"), ""),
        (EpisodeFilter(driven_by="Ben"), ""),
        (EpisodeFilter(driven_by="Be"), "driven by others"),
        (EpisodeFilter(driven_by="hold"), "driven by others"),
        (EpisodeFilter(operators=("policy", "human", "script")), ""),
        (EpisodeFilter(operators=("policy", "script")), "driven by others"),
        (EpisodeFilter(names=("lifter", "Ben", "novice")), ""),
        (EpisodeFilter(names=("lifter", "Ben")), "driven by others"),
    ],
)
def test_each_field_says_what_it_takes(wanted: EpisodeFilter, why: str) -> None:
    assert wanted.why_not(EPISODE) == why
    assert wanted.takes(EPISODE) == (not why)
    assert wanted.apply([EPISODE]) == ([] if why else [EPISODE])


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"dropped": True}, "dropped"),
        ({"error": "It is damaged."}, "cannot be read"),
        ({"outcome": "discarded"}, "discarded"),
        ({"outcome": "unspecified"}, ""),
    ],
)
def test_what_nobody_learns_from_is_not_meant(change: dict[str, object], why: str) -> None:
    assert COUNTED.why_not(EPISODE.model_copy(update=change)) == why


def test_a_list_shows_what_nobody_learns_from() -> None:
    everything = EpisodeFilter(unusable=True)
    assert everything.takes(EPISODE.model_copy(update={"dropped": True}))
    assert everything.takes(EPISODE.model_copy(update={"error": "It is damaged."}))


@given(
    st.none() | st.sampled_from(["success", "failure", "discarded"]),
    st.none() | st.sampled_from(["verified", "diverged", "unverified"]),
    st.booleans(),
)
def test_a_label_overrides_what_was_recorded(outcome: str | None, verdict: str | None, dropped: bool) -> None:
    said = EpisodeLabels(outcome=outcome, verdict=verdict, dropped=dropped)
    labelled = EPISODE.with_labels(said)
    assert labelled.outcome == (outcome or "success")
    assert labelled.verdict == (verdict or "verified")
    assert labelled.dropped == dropped
    assert labelled.verified == (labelled.verdict == "verified")
    assert EPISODE.with_labels(None) == EPISODE
