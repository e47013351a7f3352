"""A relabelled, a dropped and a discarded episode count the same for everybody who chooses from a folder."""

from __future__ import annotations

from pathlib import Path

import h5py
import pyarrow.parquet as pq
import pytest

from mart.episodes import COUNTED, EpisodeFilter, LabelKind, datasets, labels, list_episodes
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import OUTCOME_FAILURE, OUTCOME_SUCCESS, CatalogueRequest, Outcome
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.sim.world import World
from mart.trainer.data.data_spec import Selection
from mart.trainer.data.dataset import load_dataset
from mart.trainer.report.attempts import read_attempts
from mart.trainer.report.coupling import read_couplings
from tests.recorder.conftest import Mart
from tests.trainer import recorded

# number → as recorded; what people say afterwards is in `folder`.
RECORDED: dict[int, Outcome] = {
    1: OUTCOME_SUCCESS,
    2: OUTCOME_SUCCESS,  # relabelled: it failed
    3: OUTCOME_SUCCESS,  # dropped
    4: OUTCOME_FAILURE,  # relabelled: it succeeded
    5: OUTCOME_SUCCESS,  # relabelled: it does not count
    6: OUTCOME_FAILURE,
}
SUCCESSES, FAILURES = [1, 4], [2, 6]


def number_of(path: object) -> int:
    return int(Path(str(path)).name.split("-")[2])


@pytest.fixture
def folder(mart: Mart) -> Path:
    world = World.build(recorded.TASK)
    states = recorded.perform(world, 1)[:8]
    paths = {}
    for number, outcome in RECORDED.items():
        for state in states:
            state.episode = number
            state.stamps.sent_ns += 10**12
        paths[number] = recorded.write(mart.episodes_dir, world, states, outcome=outcome)
    labels.say(paths[2], LabelKind.OUTCOME, "failure", 1)
    labels.say(paths[3], LabelKind.USE, labels.DROP, 2)
    labels.say(paths[4], LabelKind.OUTCOME, "success", 3)
    labels.say(paths[5], LabelKind.OUTCOME, "discarded", 4)
    return mart.episodes_dir


def test_whoever_lists_the_successes_finds_the_same(mart: Mart, folder: Path) -> None:
    by_command = mart.json("episodes", "list", "--outcome", "success")["episodes"]
    asked = CatalogueRequest(list=CatalogueRequest.List(outcome="success"))
    by_catalogue = CatalogueHandlers(folder).answer(asked).listing
    by_door = list_episodes(folder, EpisodeFilter(outcomes=("success",), unusable=True))
    # A list shows what was dropped, and says so; nobody learns from it.
    assert [number_of(one["path"]) for one in by_command if not one["dropped"]] == SUCCESSES
    assert sorted(number_of(one.path) for one in by_catalogue.episodes if not one.dropped) == SUCCESSES
    assert [number_of(one.path) for one in by_door if not one.dropped] == SUCCESSES
    assert {number_of(one["path"]) for one in by_command if one["dropped"]} == {3}
    assert {number_of(one.path) for one in by_catalogue.episodes if one.dropped} == {3}
    assert [number_of(one.path) for one in by_door if one.dropped] == [3]


def robomimic(mart: Mart, *asked: object) -> list[int]:
    out = mart.episodes_dir.parent / "out.hdf5"
    mart("episodes", "export", "--format", "robomimic", "--out", out, *asked)
    with h5py.File(out) as file:
        return sorted(number_of(demo.attrs["episode"]) for demo in file["data"].values())


def test_exports_take_the_same(mart: Mart, folder: Path) -> None:
    assert robomimic(mart) == SUCCESSES
    out = folder.parent / "out"
    mart("episodes", "export", "--format", "lerobot", "--out", out)
    table = pq.read_table(out / "meta/episodes/chunk-000/file-000.parquet")  # it names no files
    assert len(table) == len(SUCCESSES)


def test_exports_take_the_same_failures(mart: Mart, folder: Path) -> None:
    assert robomimic(mart, "--outcome", "failure", folder) == FAILURES


@pytest.mark.parametrize(
    ("outcomes", "numbers"), [(("success",), SUCCESSES), (("failure",), FAILURES)], ids=["success", "failure"]
)
def test_training_learns_from_the_same(folder: Path, outcomes: tuple[str, ...], numbers: list[int]) -> None:
    selection = Selection.model_validate({"outcomes": outcomes})
    digest = load_dataset([folder], selection).digest
    assert [number_of(one.path) for one in digest.episodes] == numbers
    assert {one.outcome for one in digest.episodes} == set(outcomes)


def test_reports_count_the_same(folder: Path) -> None:
    (attempts,) = read_attempts(folder)
    assert sum(attempt.success for attempt in attempts.attempts) == len(SUCCESSES)
    assert sum(not attempt.success for attempt in attempts.attempts) == len(FAILURES)
    with pytest.raises(InvalidInput, match=f"^{len(SUCCESSES)} successful"):  # too few, but counted
        read_couplings(folder)


def test_data_sets_hold_the_same(mart: Mart, folder: Path) -> None:
    made = mart.json("datasets", "create", "all", "--outcome", "any")
    assert made["left_out"] == {"discarded": 1, "dropped": 1}
    held = datasets.find(labels.read_folded(folder), "all").episodes
    meant = [one.path for one in list_episodes(folder, COUNTED)]
    assert list(held) == meant
    assert [number_of(path) for path in held] == sorted(SUCCESSES + FAILURES)
