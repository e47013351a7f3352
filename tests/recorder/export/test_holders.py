"""Who held the seats as a column of every export: one numbering for all of its episodes, names only where asked for."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest

from mart.recorder.export.holders import holder_column, told_holders
from mart.sim.world import World
from tests.episodes.motions import motion
from tests.recorder.export.test_pictures import write
from tests.trainer import recorded

NAMES = ("Ana Example", "Ben Example", "Ana Example")
EACH = [1, 2, 1]  # 0 is nobody


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three episodes; Ana drove the first and the last."""
    root, world = tmp_path_factory.mktemp("held"), World.build(recorded.TASK)
    for number, name in enumerate(NAMES, start=1):
        recorded.write(root, world, recorded.perform(world, number, number=number, most_ticks=6), name=name)
    return root


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((), ["hold", "script 1", "script 2"]),
        (("--with-names",), ["hold", "script Ana Example", "script Ben Example"]),
    ],
)
def test_every_tick_says_who_held_each_seat(
    folder: Path, tmp_path: Path, arguments: tuple[str, ...], told: list[str]
) -> None:
    write(folder, tmp_path / "data_set", "lerobot", *arguments)
    rows = pq.read_table(tmp_path / "data_set/data/chunk-000/file-000.parquet")
    wanted = [[EACH[episode]] * 2 for episode in rows["episode_index"].to_pylist()]
    assert rows["holder"].to_pylist() == wanted
    assert json.loads((tmp_path / "data_set/meta/mart.json").read_text())["holders"] == told
    feature = json.loads((tmp_path / "data_set/meta/info.json").read_text())["features"]["holder"]
    assert feature == {"dtype": "int64", "shape": [2], "names": ["arm0/holder", "arm1/holder"]}
    write(folder, tmp_path / "data_set.hdf5", "robomimic", *arguments)
    with h5py.File(tmp_path / "data_set.hdf5") as file:
        assert json.loads(file["data"].attrs["holders"]) == told
        assert [int(file[f"data/demo_{demo}/holder"][0, 0]) for demo in range(3)] == EACH


def test_an_episode_has_numbers_of_its_own_and_what_is_unknown_stays_so() -> None:
    data = motion(4)
    data.holders[:] = [[0, -1]] * 4
    found = holder_column(data, ("hold", "human Ben", "human Ana"))
    np.testing.assert_array_equal(found, [[2, -1]] * 4)


def test_without_names_people_are_told_apart_by_kind() -> None:
    holders = ("hold", "human Ana", "policy act", "human Ben", "human")
    assert told_holders(holders, with_names=False) == ["hold", "human 1", "policy 1", "human 2", "human 3"]
