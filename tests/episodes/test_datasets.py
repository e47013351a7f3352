"""Named data sets, whatever is done to them: what they hold, their digest, and every change taken back."""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes import datasets
from mart.episodes.compatibility import require_alike
from mart.episodes.labels import Label, LabelKind, fold
from mart.protocol.errors import InvalidInput, NotFound

_names = st.sampled_from(["good", "few"])
_paths = st.lists(st.sampled_from("abcdef"), max_size=6)
_acts = st.lists(st.tuples(st.booleans(), _names, _paths), max_size=12)


def said_by(acts: list[tuple[bool, str, list[str]]]) -> tuple[list[Label], dict[str, set[str]]]:
    """The labels of acts at the times 1, 2, …, and what each data set then holds by plain sets."""
    said: list[Label] = []
    model: dict[str, set[str]] = {"good": set(), "few": set()}
    for at_ns, (joins, name, paths) in enumerate(acts, 1):
        change = datasets.join if joins else datasets.leave
        said += change(fold(said), name, paths, at_ns)
        model[name] = model[name] | set(paths) if joins else model[name] - set(paths)
    return said, model


@given(_acts)
def test_they_hold_what_joined_and_did_not_leave(acts: list[tuple[bool, str, list[str]]]) -> None:
    said, model = said_by(acts)
    known = datasets.named(fold(said))
    assert {name: set(one.episodes) for name, one in known.items()} == {
        name: paths for name, paths in model.items() if paths
    }
    assert all(list(one.episodes) == sorted(one.episodes) for one in known.values())


@given(_acts, _acts)
def test_the_digest_is_that_of_what_is_held(
    one: list[tuple[bool, str, list[str]]], other: list[tuple[bool, str, list[str]]]
) -> None:
    first, second = (datasets.named(fold(said_by(acts)[0])).get("good") for acts in (one, other))
    if first and second:
        assert (first.sha256 == second.sha256) == (first.episodes == second.episodes)


@given(_acts, st.booleans(), _names, _paths)
def test_an_act_that_is_undone_never_was(
    acts: list[tuple[bool, str, list[str]]], joins: bool, name: str, paths: list[str]
) -> None:
    before, _ = said_by(acts)
    change = datasets.join if joins else datasets.leave
    acted = [*before, *change(fold(before), name, paths, 100)]
    undone = [*acted, *datasets.undo(acted, name, 100, 101)]
    held = {key: one.episodes for key, one in datasets.named(fold(before)).items()}
    assert {key: one.episodes for key, one in datasets.named(fold(undone)).items()} == held
    redone = [*undone, *datasets.undo(undone, name, 101, 102)]
    assert {key: one.sha256 for key, one in datasets.named(fold(redone)).items()} == {
        key: one.sha256 for key, one in datasets.named(fold(acted)).items()
    }


def test_the_newest_act_is_of_this_data_set() -> None:
    said = [
        Label("a", LabelKind.JOIN, "good", 1),
        Label("a", LabelKind.LEAVE, "few", 2),
        Label("a", LabelKind.NOTE, "good", 3),
    ]
    assert datasets.newest_act_ns(said, "good") == 1
    with pytest.raises(NotFound):
        datasets.newest_act_ns(said, "new")
    with pytest.raises(NotFound, match="Known: good"):
        datasets.find(fold(said), "new")


@pytest.mark.parametrize("name", ["", "Good", "-a", "a b", "../a", "a" * 65, "ä"])
def test_a_name_is_one_word(name: str) -> None:
    with pytest.raises(InvalidInput):
        Label("a", LabelKind.JOIN, name, 1)


@dataclass(frozen=True)
class ComparableEpisode:
    task: str | None = "lift"
    control_hz: float | None = 20.0
    arms: tuple[str, ...] = ("arm0", "arm1")
    arm_kinds: tuple[str, ...] = ()


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (ComparableEpisode(task="wipe"), "several tasks were given: lift, wipe; split them"),
        (ComparableEpisode(control_hz=30.0), "several control rates were given: 20 Hz, 30 Hz"),
        (ComparableEpisode(arms=("arm0",)), "several sets of arms were given: arm0, arm0 and arm1"),
        (
            ComparableEpisode(arm_kinds=("panda", "ur5e")),
            r"kinds of arms \(arm_kinds\) were given: panda and panda, panda and ur5e; split them",
        ),
    ],
)
def test_what_is_learned_from_together_is_alike(other: ComparableEpisode, words: str) -> None:
    require_alike([ComparableEpisode(), ComparableEpisode()], "split them")
    require_alike([ComparableEpisode(), ComparableEpisode(control_hz=30.0)], "split them", any_rate=True)
    with pytest.raises(InvalidInput, match=words):
        require_alike([ComparableEpisode(), other], "split them")
