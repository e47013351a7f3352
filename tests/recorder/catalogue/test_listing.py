from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.messages import CatalogueRequest
from mart.recorder.catalogue.listing import MAX_COUNT, listing

Asked = CatalogueRequest.List

ROWS = [
    LabelledEpisode(path="a", size_bytes=1, task="lift", outcome="success", operators={"arm0": "human Ana"}),
    LabelledEpisode(
        path="b", size_bytes=1, task="lift", outcome="failure", skill="novice", operators={"arm0": "script"}
    ),
    LabelledEpisode(
        path="c",
        size_bytes=1,
        task="wipe",
        outcome="success",
        verdict="verified",
        operators={"arm0": "policy lifter | tick 9: human Ben"},
        datasets=("good",),
    ),
    LabelledEpisode(path="d", size_bytes=1, error="This is no MCAP file."),
]


@pytest.mark.parametrize(
    ("asked", "paths"),
    [
        (Asked(), "dcba"),
        (Asked(task="lift"), "ba"),
        (Asked(outcome="success"), "ca"),
        (Asked(outcome="success", task="lift"), "a"),
        (Asked(verdict="verified"), "c"),
        (Asked(skill="novice"), "b"),
        (Asked(dataset="good"), "c"),
        (Asked(dataset="goo"), ""),
        (Asked(operator="human"), "ca"),
        (Asked(operator="policy"), "c"),
        (Asked(operator="Ben"), "c"),
        (Asked(operator="lifter"), "c"),
        (Asked(operator="Be"), ""),
        (Asked(offset=1, count=2), "cb"),
        (Asked(offset=9), ""),
    ],
)
def test_a_page_holds_what_was_asked_for_newest_first(asked: CatalogueRequest.List, paths: str) -> None:
    assert "".join(episode.path for episode in listing(ROWS, asked).episodes) == paths


def test_it_says_how_many_there_are_and_what_to_choose_from() -> None:
    told = listing(ROWS, Asked(task="lift", count=1))
    assert (told.matching, told.successes, len(told.episodes)) == (2, 1, 1)
    assert list(told.tasks) == ["lift", "wipe"]
    assert list(told.operators) == ["Ana", "Ben", "lifter"]


def test_what_each_has_driven_is_added_up_since_a_time() -> None:
    def episode(path: str, started_ns: int, outcome: str, driver: str) -> LabelledEpisode:
        return LabelledEpisode(
            path=path,
            size_bytes=1,
            outcome=outcome,
            simulated_s=10.0,
            started_ns=started_ns,
            operators={"arm0": driver, "arm1": "script"},
        )

    rows = [
        episode("a", 1, "success", "human Ana"),
        episode("b", 5, "success", "human Ana | tick 9: human Ben"),
        episode("c", 6, "failure", "human Ana"),
    ]
    told = listing(rows, Asked(since_ns=5))
    assert (told.matching, told.successes, told.simulated_s) == (2, 1, 20.0)
    drivers = [(one.name, one.episodes, one.successes, one.simulated_s) for one in told.drivers]
    assert drivers == [("Ana", 2, 1, 20.0), ("Ben", 1, 1, 10.0)]
    assert len(listing(rows, Asked()).drivers) == 2


def test_an_episode_travels_whole() -> None:
    (episode,) = listing(ROWS, Asked(operator="Ben")).episodes
    assert (episode.task, episode.verdict, episode.HasField("real_time_factor")) == (
        "wipe",
        "verified",
        False,
    )
    assert dict(episode.operators) == {"arm0": "policy lifter | tick 9: human Ben"}


@given(st.integers(0, 500), st.integers(0, 500), st.integers(0, 2**32 - 1))
def test_pages_are_bounded_and_together_they_are_everything(rows: int, count: int, offset: int) -> None:
    made = [LabelledEpisode(path=str(number), size_bytes=0) for number in range(rows)]
    page = listing(made, Asked(count=count, offset=offset))
    assert len(page.episodes) <= min(count or 50, MAX_COUNT)
    assert page.matching == rows
    assert [one.path for one in page.episodes] == [row.path for row in reversed(made)][
        offset : offset + min(count or 50, MAX_COUNT)
    ]
