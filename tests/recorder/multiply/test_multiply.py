"""The whole way: recorded episodes, a replica of the real sim, generated files. A kill in the middle loses nothing."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mart.episodes import EpisodeFilter, list_episodes
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Conflict, InvalidInput
from mart.protocol.messages import OPERATOR_GENERATED
from mart.protocol.recording import GeneratedRecord
from mart.protocol.vocabulary import OperatorKind
from mart.recorder.multiply.multiplication import LOG, Batch, world_seed
from mart.recorder.multiply.multiplying import MultiplyOrder, multiplying
from mart.sim.world import World
from tests.trainer.recorded import TASK, perform, write

pytestmark = pytest.mark.system

WANTED = 3


@pytest.fixture(scope="module")
def demonstrations(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three episodes of experts."""
    root = tmp_path_factory.mktemp("demonstrations")
    world = World.build(TASK)
    for number, seed in enumerate((1, 2, 3), start=1):
        write(root, world, perform(world, seed, number))
    return root


def make(order: MultiplyOrder) -> list[Batch]:
    with multiplying(order) as (_, batches):
        return list(batches)


@pytest.fixture(scope="module")
def order(demonstrations: Path, tmp_path_factory: pytest.TempPathFactory) -> MultiplyOrder:
    return MultiplyOrder((demonstrations,), TASK, WANTED, tmp_path_factory.mktemp("generated") / "episodes")


@pytest.fixture(scope="module")
def made(order: MultiplyOrder) -> list[Batch]:
    return make(order)


def test_what_succeeds_is_a_verified_episode_that_says_of_what_it_was_made(
    order: MultiplyOrder, made: list[Batch]
) -> None:
    listed = list_episodes([order.out])
    assert len(listed) == WANTED == sum(len(batch.kept) for batch in made)
    for episode in listed:
        assert (episode.outcome, episode.verdict, episode.mode) == ("success", "verified", "generated")
        assert set(episode.operators.values()) == {OperatorKind.GENERATED.value}
        data = episode.open().arrays()
        assert (data.sources == OPERATOR_GENERATED).all()
        record = GeneratedRecord.from_strings(
            EpisodeFile.open(episode.file_path).metadata[GeneratedRecord.NAME]
        )
        assert episode.seed == world_seed(record.seed, record.attempt)
        assert record.segments.keys() == {"arm0", "arm1"}
        assert "@cube0" in record.segments["arm0"]


def test_generated_episodes_are_filtered_like_those_of_other_operators(
    order: MultiplyOrder, made: list[Batch]
) -> None:
    listed = list_episodes([order.out])
    assert len(EpisodeFilter(driven_by="generated").apply(listed)) == WANTED
    assert EpisodeFilter(operators=("human", "script", "policy")).apply(listed) == []


def test_one_that_was_killed_goes_on_and_makes_the_same(
    order: MultiplyOrder, made: list[Batch], tmp_path: Path
) -> None:
    other = MultiplyOrder(order.paths, TASK, WANTED, tmp_path / "episodes")
    make(MultiplyOrder(order.paths, TASK, 1, other.out))
    log = other.out / LOG
    log.write_bytes(log.read_bytes() + b'{"torn')
    make(other)
    first, again = ({one.seed: one for one in list_episodes([out])} for out in (order.out, other.out))
    assert first.keys() == again.keys()
    for seed, one in first.items():
        assert np.array_equal(one.open().arrays().actions, again[seed].open().arrays().actions)


def test_a_kill_before_the_batch_was_noted_makes_no_episode_twice(
    order: MultiplyOrder, made: list[Batch]
) -> None:
    before = {one.path for one in list_episodes([order.out])}
    (order.out / LOG).unlink()
    make(order)
    assert {one.path for one in list_episodes([order.out])} == before


def test_a_folder_of_other_demonstrations_is_left_alone(order: MultiplyOrder, made: list[Batch]) -> None:
    with pytest.raises(Conflict):
        make(MultiplyOrder(order.paths, TASK, WANTED, order.out, seed=1))
    lines = (order.out / LOG).read_text().splitlines()
    assert all(json.loads(line)["seed"] == 0 for line in lines)


def test_generated_episodes_are_no_sources_unless_it_is_said(order: MultiplyOrder, made: list[Batch]) -> None:
    with pytest.raises(InvalidInput) as refused:
        make(MultiplyOrder((order.out,), TASK, 1, order.out.with_name("other")))
    assert "--from-generated" in str(refused.value)
