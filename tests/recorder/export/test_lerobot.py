"""LeRobot's folder: the source's numbers, frame by frame, and what its reader asks of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from mart.episodes.arrays import EpisodeData
from mart.episodes.reader import open_episode
from mart.protocol.errors import Conflict, InvalidInput
from mart.protocol.tasks import get_task
from mart.recorder.export_cli import export
from mart.sim.world import World
from tests.trainer import recorded

TASK = get_task(recorded.TASK)


class Exported:
    """Two episodes, and the folder that was made of them."""

    def __init__(self, root: Path) -> None:
        world = World.build(recorded.TASK)
        paths = [
            recorded.write(root / "episodes", world, recorded.perform(world, seed, number=seed)[:30])
            for seed in (1, 2)
        ]
        self.root, self.folder = root, root / "lifting"
        self.sources = [open_episode(path).arrays(TASK) for path in paths]
        write(root / "episodes", self.folder)

    def json(self, name: str) -> dict[str, Any]:
        found: dict[str, Any] = json.loads((self.folder / "meta" / name).read_text())
        return found

    def column(self, name: str) -> np.ndarray:
        table = pq.read_table(self.folder / "data/chunk-000/file-000.parquet")
        return np.array(table[name].to_pylist())


def write(episodes: Path, out: Path) -> None:
    export.main([str(episodes), "--format", "lerobot", "--out", str(out)], standalone_mode=False)


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Exported:
    return Exported(tmp_path_factory.mktemp("lerobot"))


def joined(sources: list[EpisodeData], *names: str) -> np.ndarray:
    """What is seen before each action, float32[frames, width]."""
    parts = [np.concatenate([one.observations[name][:-1] for name in names], axis=1) for one in sources]
    return np.concatenate(parts).astype(np.float32)


def test_frames_are_the_source(exported: Exported) -> None:
    own = [one.name for one in TASK.observations if one.name.startswith("arm")]
    rest = [one.name for one in TASK.observations if not one.name.startswith("arm")]
    actions = np.concatenate([one.actions.reshape(len(one), -1) for one in exported.sources])
    np.testing.assert_array_equal(exported.column("observation.state"), joined(exported.sources, *own))
    np.testing.assert_array_equal(
        exported.column("observation.environment_state"), joined(exported.sources, *rest)
    )
    np.testing.assert_array_equal(exported.column("action"), actions.astype(np.float32))


def test_frames_are_numbered_and_timed(exported: Exported) -> None:
    lengths = [len(one) for one in exported.sources]
    frames = np.concatenate([np.arange(length) for length in lengths])
    assert exported.column("index").tolist() == list(range(sum(lengths)))
    assert exported.column("frame_index").tolist() == frames.tolist()
    assert exported.column("episode_index").tolist() == np.repeat([0, 1], lengths).tolist()
    np.testing.assert_allclose(exported.column("timestamp"), frames / 20.0, rtol=1e-6)
    assert np.flatnonzero(exported.column("next.done")).tolist() == (np.cumsum(lengths) - 1).tolist()


def test_the_folder_describes_itself(exported: Exported) -> None:
    info = exported.json("info.json")
    frames = sum(len(one) for one in exported.sources)
    assert (info["codebase_version"], info["fps"], info["total_frames"]) == ("v3.0", 20, frames)
    assert info["features"]["action"]["shape"] == [14]
    assert (
        len(info["features"]["observation.state"]["names"])
        == info["features"]["observation.state"]["shape"][0]
    )
    assert exported.json("stats.json")["action"]["count"] == [frames]
    episodes = pq.read_table(exported.folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [one["dataset_from_index"] for one in episodes] == [0, len(exported.sources[0])]
    assert episodes[1]["tasks"] == [TASK.instruction]


def test_every_episode_has_its_own_statistics(exported: Exported) -> None:
    """In the columns from which LeRobot's tools make those of what is left, merged or split."""
    features = exported.json("info.json")["features"]
    rows = pq.read_table(exported.folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    names = ("min", "max", "mean", "std", "count", "q01", "q10", "q50", "q90", "q99")
    assert {name for name in rows[0] if name.startswith("stats/")} == {
        f"stats/{feature}/{name}" for feature in features for name in names
    }
    for row in rows:
        part = slice(row["dataset_from_index"], row["dataset_to_index"])
        for feature in features:
            values = exported.column(feature)[part].reshape(row["length"], -1).astype(np.float64)
            stats = {name: row[f"stats/{feature}/{name}"] for name in names}
            assert stats["count"] == [row["length"]]
            np.testing.assert_allclose(stats["mean"], values.mean(0), atol=1e-9)
            np.testing.assert_allclose(stats["std"], values.std(0), atol=1e-9)
            np.testing.assert_array_equal(stats["max"], values.max(0))
            np.testing.assert_allclose(stats["q90"], np.quantile(values, 0.9, axis=0))
    means = np.array([row["stats/action/mean"] for row in rows])
    lengths = np.array([row["length"] for row in rows])
    aggregated = (means * lengths[:, None]).sum(0) / lengths.sum()
    np.testing.assert_allclose(aggregated, exported.json("stats.json")["action"]["mean"], atol=1e-9)


def test_each_tick_says_who_drove_and_whether_the_clutch_was_held(exported: Exported) -> None:
    sources = np.concatenate([one.sources for one in exported.sources])
    engaged = np.concatenate([one.engaged for one in exported.sources])
    np.testing.assert_array_equal(exported.column("source"), sources)
    np.testing.assert_array_equal(exported.column("engaged"), engaged)
    held = np.concatenate([one.held for one in exported.sources])
    np.testing.assert_array_equal(exported.column("held"), held)
    features = exported.json("info.json")["features"]
    assert features["source"] == {"dtype": "int64", "shape": [2], "names": ["arm0/source", "arm1/source"]}
    assert features["engaged"]["dtype"] == "bool"


def test_the_tasks_table_is_indexed_by_words(exported: Exported) -> None:
    table = pq.read_table(exported.folder / "meta/tasks.parquet")
    index = json.loads(table.schema.metadata[b"pandas"])["index_columns"]
    assert table[index[0]].to_pylist() == [TASK.instruction]
    assert table["task_index"].to_pylist() == [0]


def test_nothing_is_overwritten_and_nothing_half_is_left(exported: Exported, tmp_path: Path) -> None:
    with pytest.raises(Conflict):
        write(exported.root / "episodes", exported.folder)
    world = World.build(recorded.TASK)
    states = recorded.perform(world, 1)[:10]
    recorded.write(tmp_path / "episodes", world, [*states[:5], *states[6:]])
    with pytest.raises(InvalidInput):
        write(tmp_path / "episodes", tmp_path / "lifting")
    assert [path.name for path in tmp_path.iterdir()] == ["episodes"]


def test_episodes_of_a_higher_rate_are_told_in_ticks_of_the_usual_one(tmp_path: Path) -> None:
    world = World.build(recorded.TASK)
    path = recorded.write(tmp_path / "episodes", world, recorded.perform(world, 1)[:30], control_hz=60.0)
    write(tmp_path / "episodes", tmp_path / "lifting")
    told = open_episode(path).arrays(TASK, 20.0)
    table = pq.read_table(tmp_path / "lifting/data/chunk-000/file-000.parquet")
    assert json.loads((tmp_path / "lifting/meta/info.json").read_text())["fps"] == 20
    np.testing.assert_allclose(table["timestamp"].to_numpy(), 0.05 * np.arange(10), atol=1e-6)
    np.testing.assert_allclose(table["action"].to_pylist(), told.actions.reshape(10, -1), atol=1e-6)
