"""Training on a named data set: whole, and what is no longer fit for it is said."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from mart.episodes import labels
from mart.episodes.labels import LabelKind
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import OUTCOME_FAILURE
from mart.protocol.vocabulary import Verdict
from mart.trainer.data.dataset import load_dataset
from mart.trainer.data.named_dataset import WHOLE, NamedData, find_dataset
from tests.trainer import recorded
from tests.trainer.conftest import Recorded


@pytest.fixture
def root(episodes: Recorded, tmp_path: Path) -> Path:
    """The three episodes, and a failure that nobody verified; the data set `good` holds all but the first."""
    root = tmp_path / "episodes"
    shutil.copytree(episodes.root, root)
    failure = recorded.perform(episodes.world, 4, number=4)
    recorded.write(root, episodes.world, failure, outcome=OUTCOME_FAILURE, verdict=Verdict.UNVERIFIED)
    for at_ns, path in enumerate(files(root)[1:]):
        labels.say(path, LabelKind.JOIN, "good", at_ns)
    return root


def files(root: Path) -> list[Path]:
    return sorted(root.rglob("*.mcap"))


def learned(root: Path) -> tuple[list[str], NamedData]:
    dataset, paths = find_dataset(root, "good")
    digest = load_dataset(paths, WHOLE, dataset=dataset).digest
    assert digest.dataset is not None
    return [Path(one.path).name[7:11] for one in digest.episodes], digest.dataset


def test_it_is_taken_whole_with_its_name_and_digest(root: Path) -> None:
    episodes, told = learned(root)
    assert episodes == ["0002", "0003", "0004"]
    assert (told.name, told.episodes, told.left_out) == ("good", 3, ())
    labels.say(files(root)[0], LabelKind.JOIN, "good", 9)
    assert learned(root)[1].sha256 != told.sha256


def test_what_was_dropped_discarded_or_deleted_since_is_said(
    root: Path, caplog: pytest.LogCaptureFixture
) -> None:
    _, second, third, fourth = files(root)
    labels.say(second, LabelKind.USE, "drop", 10)
    labels.say(fourth, LabelKind.OUTCOME, "discarded", 11)
    episodes, told = learned(root)
    assert episodes == ["0003"]
    assert {Path(one.path).name: one.why for one in told.left_out} == {
        second.name: "dropped",
        fourth.name: "discarded",
    }
    assert "2 of the 3 episodes of the data set good are left out" in caplog.text
    labels.say(second, LabelKind.USE, "keep", 12)
    third.unlink()
    episodes, told = learned(root)
    assert episodes == ["0002"]
    assert [one.why for one in told.left_out] == ["deleted", "discarded"]


def test_nothing_left_and_no_such_data_set_are_said(root: Path) -> None:
    with pytest.raises(NotFound, match="Did you mean 'good'"):
        find_dataset(root, "goods")
    dataset, paths = find_dataset(root, "good")
    for path in paths:
        path.unlink()
    with pytest.raises(InvalidInput, match="Every episode of the data set 'good' was deleted"):
        load_dataset(paths, WHOLE, dataset=dataset)


def test_a_narrower_selection_is_said_too(root: Path) -> None:
    dataset, paths = find_dataset(root, "good")
    narrow = WHOLE.model_copy(update={"verdicts": ("verified",), "first": 1})
    told = load_dataset(paths, narrow, dataset=dataset).digest.dataset
    assert told is not None
    assert [one.why for one in told.left_out] == ["beyond the number asked for", "unverified"]
