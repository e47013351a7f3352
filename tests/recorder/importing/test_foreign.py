"""Other people's data, whole, odd and hostile: taken as numbers, or told of in a sentence, and nothing left half."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from mart.episodes.filter import EpisodeFilter
from mart.episodes.folder import list_episodes
from mart.episodes.reader import open_episode
from mart.protocol.errors import Corrupt, InvalidInput, MartError
from mart.protocol.vocabulary import GOOD_VERDICTS
from mart.recorder.export.selection import choose
from mart.recorder.import_cli import import_
from mart.recorder.importing.import_episodes import Imported
from tests.recorder.importing import sources

ACTIONS = np.arange(40.0).reshape(8, 5) / 10
SEEN = np.arange(24.0).reshape(8, 3)
ROBOSUITE = json.dumps({"env_name": "Lift", "type": 1, "env_kwargs": {"control_freq": 20}})


def files_in(folder: Path) -> list[Path]:
    return [one for one in folder.rglob("*") if one.is_file()]


def test_robomimic_of_others_is_to_be_looked_at(tmp_path: Path) -> None:
    pictures = np.zeros((8, 84, 84, 3), np.uint8)
    values = {
        "actions": ACTIONS,
        "obs/eef_pos": SEEN,
        "obs/agentview_image": pictures,
        "rewards": np.eye(8)[7],
    }
    sources.write_demo(tmp_path / "Lift (ph).hdf5", values, env_args=ROBOSUITE)
    one = sources.only(sources.imported(tmp_path / "Lift (ph).hdf5", tmp_path / "in"))
    assert (one.task, one.verdict, one.ticks) == (None, "unverified", 7)
    assert "agentview_image" in one.left_out[0]
    (listed,) = list_episodes(tmp_path / "in")
    assert (listed.mode, listed.outcome, listed.room) == ("imported", "unspecified", "lift-ph")
    assert listed.control_hz == 20
    data = open_episode(one.path).arrays()
    np.testing.assert_array_equal(data.observations["eef_pos"], SEEN)
    np.testing.assert_array_equal(data.observations["action"], ACTIONS)


def test_what_is_to_be_looked_at_is_in_no_training_set(tmp_path: Path) -> None:
    sources.write_demo(tmp_path / "a.hdf5", {"actions": ACTIONS})
    sources.only(sources.imported(tmp_path / "a.hdf5", tmp_path / "in"))
    listed = list_episodes(tmp_path / "in")
    usual = EpisodeFilter(outcomes=("success",), verdicts=GOOD_VERDICTS)
    assert not usual.apply(listed)
    with pytest.raises(InvalidInput):
        choose(listed, EpisodeFilter())  # whatever the filter is: it is of no task


def _nan(path: Path) -> None:
    sources.write_demo(path, {"actions": np.full((4, 3), np.nan)})


def _strings(path: Path) -> None:
    sources.write_demo(path, {"actions": np.array([b"x", b"y"])})


def _objects(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset("data/demo_0/actions", (3,), h5py.vlen_dtype(np.float64))


def _empty(path: Path) -> None:
    sources.write_demo(path, {"obs/x": SEEN})


def _uneven(path: Path) -> None:
    sources.write_demo(path, {"actions": ACTIONS, "obs/x": SEEN[:3]})


def _long(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset("data/demo_0/actions", (10**12, 7), "f8", chunks=(1000, 7), compression="gzip")


def _bomb(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset(
            "data/demo_0/actions", (400_000, 4000), "f8", chunks=(400_000, 4000), compression="gzip"
        )


def _many(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset(
            "data/demo_0/actions", (400_000, 4000), "f8", chunks=(1000, 40), compression="gzip"
        )


def _soft(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["data/demo_0/obs/x"] = SEEN
        file["data/demo_0/actions"] = h5py.SoftLink("/data/demo_0/obs/x")


def _external(path: Path) -> None:
    with h5py.File(path.with_name("secret.hdf5"), "w") as file:
        file["actions"] = ACTIONS
    with h5py.File(path, "w") as file:
        file.create_group("data/demo_0")["actions"] = h5py.ExternalLink("secret.hdf5", "/actions")


def _raw(path: Path) -> None:
    path.with_name("secret.raw").write_bytes(ACTIONS.tobytes())
    with h5py.File(path, "w") as file:
        place = [(str(path.with_name("secret.raw")), 0, ACTIONS.nbytes)]
        file.create_dataset("data/demo_0/actions", ACTIONS.shape, "f8", external=place)


def _virtual(path: Path) -> None:
    with h5py.File(path.with_name("secret.hdf5"), "w") as file:
        file["actions"] = ACTIONS
    layout = h5py.VirtualLayout(ACTIONS.shape, "f8")
    layout[:] = h5py.VirtualSource(path.with_name("secret.hdf5"), "actions", ACTIONS.shape)
    with h5py.File(path, "w") as file:
        file.create_group("data/demo_0").create_virtual_dataset("actions", layout)


def _cycle(path: Path) -> None:
    with h5py.File(path, "w") as file:
        demo = file.create_group("data/demo_0")
        demo["actions"] = ACTIONS
        demo["obs"] = demo


def _cycle_of_groups(path: Path) -> None:
    with h5py.File(path, "w") as file:
        demo = file.create_group("data/demo_0")
        demo["actions"] = file["data"]


def _short(path: Path) -> None:
    sources.write_demo(path, {"actions": ACTIONS[:1]})


HOSTILE: dict[Callable[[Path], None], str] = {
    _nan: "NaN",
    _strings: "numbers are wanted",
    _objects: "numbers are wanted",
    _empty: "no actions",
    _uneven: "as many",
    _long: "rows",
    _bomb: "chunks",
    _many: "MiB of numbers",
    _soft: "link",
    _external: "link",
    _raw: "another file",
    _virtual: "another file",
    _cycle: "is a group",
    _cycle_of_groups: "is a group",
    _short: "at least 2",
}


@pytest.mark.parametrize("make", HOSTILE, ids=lambda make: make.__name__)
def test_a_demonstration_that_cannot_be_used(make: Callable[[Path], None], tmp_path: Path) -> None:
    make(tmp_path / "a.hdf5")
    assert HOSTILE[make] in sources.why(sources.imported(tmp_path / "a.hdf5", tmp_path / "in"))
    assert not files_in(tmp_path / "in")


def test_the_good_ones_are_imported_beside_it(tmp_path: Path) -> None:
    sources.write_demo(tmp_path / "a.hdf5", {"actions": ACTIONS}, demo="demo_10")
    sources.write_demo(tmp_path / "a.hdf5", {"actions": ACTIONS * np.nan}, demo="demo_9")
    sources.write_demo(tmp_path / "a.hdf5", {"actions": ACTIONS}, demo="demo_2")
    report = sources.imported(tmp_path / "a.hdf5", tmp_path / "in")
    assert [(one.name, isinstance(one, Imported)) for one in report] == [
        ("demo_2", True),
        ("demo_9", False),
        ("demo_10", True),
    ]
    assert import_.main([str(tmp_path / "a.hdf5"), "--out", str(tmp_path / "b")], standalone_mode=False) == 1
    assert len(files_in(tmp_path / "b")) == 2


@pytest.mark.parametrize("content", [b"", b"no HDF5 at all", b"\x89HDF\r\n\x1a\n" + bytes(100)])
def test_what_is_no_hdf5(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.hdf5").write_bytes(content)
    with pytest.raises(Corrupt):
        sources.imported(tmp_path / "a.hdf5", tmp_path / "in")


def test_a_file_that_was_cut_off(tmp_path: Path) -> None:
    sources.write_demo(tmp_path / "a.hdf5", {"actions": np.random.default_rng(1).random((200, 50))})
    whole = (tmp_path / "a.hdf5").read_bytes()
    for size in range(0, len(whole), 4001):
        (tmp_path / "cut.hdf5").write_bytes(whole[:size])
        with pytest.raises(MartError):
            sources.imported(tmp_path / "cut.hdf5", tmp_path / "in")


def test_a_task_takes_what_it_can_learn_from(tmp_path: Path) -> None:
    sources.write_demo(tmp_path / "a.hdf5", {"actions": np.zeros((4, 14)), "obs/x": SEEN[:4]})
    report = sources.imported(tmp_path / "a.hdf5", tmp_path / "in", task="two_arm_multi_cube_lifting")
    assert "are missing" in sources.why(report)
