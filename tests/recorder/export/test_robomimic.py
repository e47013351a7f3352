"""The HDF5 that robomimic reads: the source's numbers, the trainer's alignment, and what is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
import pytest

from mart.episodes.arrays import arrays_for_task
from mart.episodes.filter import EpisodeFilter
from mart.episodes.folder import list_episodes
from mart.episodes.labels import LabelKind, say
from mart.episodes.reader import open_episode
from mart.protocol.errors import Conflict, Corrupt, InvalidInput
from mart.protocol.messages import OUTCOME_FAILURE, State
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import Verdict
from mart.recorder.catalogue.episode_catalogue import list_paths
from mart.recorder.export.robomimic import key_of, write_robomimic
from mart.recorder.export.selection import ExportSelection, choose, read_segments
from mart.recorder.export_cli import export
from mart.sim.world import World
from mart.trainer.data.episode import from_states as as_the_trainer
from mart.trainer.data.layout import ObservationLayout
from tests.recorder import synthetic
from tests.recorder.files import write_episode
from tests.trainer import recorded

TASK = get_task(recorded.TASK)


@dataclass(frozen=True)
class Source:
    world: World
    episodes: tuple[list[State], ...]


@pytest.fixture(scope="module")
def source() -> Source:
    world = World.build(recorded.TASK)
    return Source(world, tuple(recorded.perform(world, seed, number=seed) for seed in (1, 2)))


@pytest.fixture
def folder(source: Source, tmp_path: Path) -> Path:
    """Two verified successes; and the first one again as a failure, and as one that nobody has verified."""
    first, second = source.episodes
    recorded.write(tmp_path, source.world, first)
    recorded.write(tmp_path, source.world, second)
    recorded.write(tmp_path, source.world, renumbered(first, 3), outcome=OUTCOME_FAILURE)
    recorded.write(tmp_path, source.world, renumbered(first, 4), verdict=Verdict.UNVERIFIED)
    return tmp_path


def renumbered(states: list[State], number: int) -> list[State]:
    return [changed(state, lambda copy: setattr(copy, "episode", number)) for state in states]


def open_states(path: Path) -> list[State]:
    return list(open_episode(path).states())


def changed(state: State, change: Callable[[State], object]) -> State:
    copy = State.FromString(state.SerializeToString())
    change(copy)
    return copy


def write(folder: Path, out: Path, *arguments: str) -> None:
    command = [str(folder), "--format", "robomimic", "--out", str(out), *arguments]
    export.main(command, standalone_mode=False)


def test_the_file_is_the_source(source: Source, folder: Path) -> None:
    write(folder, folder / "lifting.hdf5")
    with h5py.File(folder / "lifting.hdf5") as file:
        data = file["data"]
        assert sorted(data) == ["demo_0", "demo_1"]
        assert data.attrs["total"] == sum(len(states) - 1 for states in source.episodes)
        for states, demo in zip(source.episodes, ("demo_0", "demo_1"), strict=True):
            assert_holds(data[demo], states)


def assert_holds(demo: h5py.Group, states: list[State]) -> None:
    before, after = states[:-1], states[1:]
    assert demo.attrs["num_samples"] == len(before)
    assert (
        sorted(demo["obs"]) == sorted(demo["next_obs"]) == sorted(key_of(o.name) for o in TASK.observations)
    )
    for column, wanted in enumerate(TASK.observations):
        for key, seen in (("obs", before), ("next_obs", after)):
            values = [state.observations[column].value for state in seen]
            np.testing.assert_array_equal(
                demo[key][key_of(wanted.name)][:], np.reshape(values, (-1, *wanted.shape))
            )
    joined = [[number for arm in state.arms for number in arm.action] for state in after]
    np.testing.assert_array_equal(demo["actions"][:], joined)
    assert demo["states"][0].tobytes() == before[0].integration_state
    assert demo["states"][-1].tobytes() == before[-1].integration_state
    assert demo["dones"][:].tolist() == [0] * (len(before) - 1) + [1]
    assert demo["source"][:].tolist() == [[arm.source for arm in state.arms] for state in after]
    assert demo["engaged"][:].tolist() == [[arm.engaged for arm in state.arms] for state in after]
    assert demo["held"][:].tolist() == [[not arm.fresh for arm in state.arms] for state in after]
    assert demo["rewards"][:].tolist() == [float(state.progress.success) for state in after]


def test_a_fumbled_stretch_is_absent_and_the_rest_are_demonstrations(source: Source, folder: Path) -> None:
    first = min(folder.rglob("*.mcap"))
    say(first, LabelKind.CUT, "20-50", at_ns=1)
    write(folder, folder / "cut.hdf5")
    with h5py.File(folder / "cut.hdf5") as file:
        data = file["data"]
        assert sorted(data) == ["demo_0", "demo_1", "demo_2"]
        assert_holds(data["demo_0"], source.episodes[0][:21])
        assert_holds(data["demo_1"], source.episodes[0][50:])
        assert data["demo_1/ticks"][0] == 50
        assert sorted(file["mask/success"].asstr()) == ["demo_0", "demo_1", "demo_2"]


def test_observation_and_action_stand_side_by_side_as_in_training(source: Source) -> None:
    layout = ObservationLayout.of(TASK)
    for states in source.episodes:
        ours, trainers = arrays_for_task(states, TASK), as_the_trainer(layout, states)
        np.testing.assert_array_equal(ours.actions.astype(np.float32), trainers.actions)
        np.testing.assert_array_equal(layout.vector(ours.observations), trainers.observations)


def test_what_the_file_is_stands_in_it(folder: Path) -> None:
    say(max(folder.rglob("*.mcap")), LabelKind.JOIN, "late", at_ns=1)
    write(folder, folder / "lifting.hdf5", "--outcome", "any", "--verdict", "any")
    with h5py.File(folder / "lifting.hdf5") as file:
        environment = json.loads(file["data"].attrs["env_args"])
        observations = json.loads(file["data"].attrs["observations"])
        sources = json.loads(file["data"].attrs["source"])
        groups = {key: [name.decode() for name in names] for key, names in file["mask"].items()}
    assert environment["env_name"] == recorded.TASK
    assert sources == {"1": "hold", "2": "human", "3": "policy", "4": "script", "5": "generated"}
    assert environment["env_kwargs"] == {"control_hz": 20.0, "arms": 2}
    assert observations["arm1_gripper"]["arms"] == ["arm1"]
    assert groups["success"] == ["demo_0", "demo_2", "demo_3"]
    assert groups["failure"] == ["demo_1"]
    assert groups["dataset-late"] == ["demo_2"]
    write(folder, folder / "late.hdf5", "--dataset", "late", "--verdict", "any")
    with h5py.File(folder / "late.hdf5") as file:
        assert list(file["data"]) == ["demo_0"]


def test_only_what_is_asked_for_is_taken(folder: Path) -> None:
    def count(outcomes: tuple[str, ...], verdicts: tuple[str, ...]) -> int:
        wanted = EpisodeFilter(outcomes=outcomes, verdicts=verdicts)
        return len(choose(list_paths([folder]), wanted).episodes)

    assert count(("success",), ("verified",)) == 2
    assert count(("success", "failure"), ("verified",)) == 3
    assert count((), ()) == 4
    say(min(folder.rglob("*.mcap")), LabelKind.USE, "drop", at_ns=1)
    assert count((), ()) == 3
    with pytest.raises(InvalidInput, match="1 dropped"):
        count(("discarded",), ())
    assert len(choose(list_paths([folder, folder]), EpisodeFilter()).episodes) == 3


def test_nothing_is_overwritten_and_nothing_half_is_left(source: Source, folder: Path) -> None:
    out = folder / "lifting.hdf5"
    write(folder, out)
    with pytest.raises(Conflict):
        write(folder, out)
    broken = [*source.episodes[0][:5], *source.episodes[0][6:]]
    recorded.write(folder, source.world, renumbered(broken, 5))
    with pytest.raises(InvalidInput, match="0005"):
        write(folder, folder / "other.hdf5")
    assert [path.name for path in folder.iterdir() if "hdf5" in path.name] == [out.name]


@pytest.mark.parametrize(("field", "value"), [("control_hz", 30.0), ("task", "two_arm_table_assembly")])
def test_a_mixture_is_refused(source: Source, folder: Path, field: str, value: object) -> None:
    recorded.write(folder, source.world, renumbered(source.episodes[0], 5), **{field: value})  # type: ignore[arg-type]
    with pytest.raises(InvalidInput):
        write(folder, folder / "lifting.hdf5", "--control-hz", "own")


def test_episodes_of_several_rates_are_told_at_one(source: Source, folder: Path) -> None:
    """Recorded at 60 Hz, the first of these says the same in ticks of 20 Hz as `arrays` does."""
    recorded.write(folder, source.world, renumbered(source.episodes[0], 5), control_hz=60.0)
    write(folder, folder / "lifting.hdf5")
    told = open_episode(next(folder.rglob("*-0005-*.mcap"))).arrays(TASK, 20.0)
    with h5py.File(folder / "lifting.hdf5") as file:
        assert json.loads(file["data"].attrs["env_args"])["env_kwargs"]["control_hz"] == 20.0
        demo = file["data/demo_1"]  # of the same start as the first
        np.testing.assert_array_equal(demo["actions"][:], told.actions.reshape(len(told), -1))
        np.testing.assert_array_equal(demo["next_obs/arm0_gripper"][:], told.observations["arm0/gripper"][1:])
        assert len(told) == -(-(len(source.episodes[0]) - 1) // 3)


@pytest.mark.parametrize("given", ["60", "-1", "fast", "nan"])
def test_a_rate_that_cannot_be_had_is_refused(folder: Path, given: str) -> None:
    with pytest.raises(InvalidInput):
        write(folder, folder / "lifting.hdf5", "--control-hz", given)


def test_a_file_that_cannot_be_read_is_named_and_in_nobodys_way(
    folder: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """One is cut off, one has a broken chunk, one is another's; named itself, each is an error."""
    first, second = sorted(folder.rglob("*.mcap"))[:2]
    recorded.write(folder, World.build(recorded.TASK), renumbered(open_states(second), 7))
    foreign = folder / "foreign.mcap"
    foreign.write_bytes(b"PAR1")
    first.write_bytes(first.read_bytes()[:5000])
    data = bytearray(second.read_bytes())
    data[data.index(b"zstd") + 2000] ^= 1
    second.write_bytes(data)
    write(folder, folder / "lifting.hdf5")
    with h5py.File(folder / "lifting.hdf5") as file:
        assert len(file["data"]) == 1
    for path in (first, second, foreign):
        assert f"Left out: {path}" in caplog.text
        with pytest.raises(Corrupt, match=path.name):
            write(path, folder / "none.hdf5")


def read_one(path: Path) -> None:
    episodes = list_episodes(path)
    read_segments(ExportSelection(TASK, episodes[0].control_hz or 20.0, tuple(episodes)), episodes[0])


def test_an_episode_whose_model_has_a_spoilt_bit_is_not_exported(tmp_path: Path) -> None:
    path = write_episode(tmp_path).path
    data = bytearray(path.read_bytes())
    data[data.index(synthetic.MJB)] ^= 1
    path.write_bytes(data)
    with pytest.raises(Corrupt, match="checksum"):
        read_one(path)


@pytest.mark.parametrize(
    "change",
    [
        lambda state: state.observations[0].value.__setitem__(0, np.nan),
        lambda state: state.observations[0].value.pop(),
        lambda state: state.observations.pop(0),
        lambda state: state.arms[1].action.__setitem__(0, np.nan),
        lambda state: state.arms[1].action.__setitem__(0, 1.5),
        lambda state: state.arms.pop(),
        lambda state: setattr(state, "integration_state", b"short"),
    ],
)
def test_what_cannot_be_learned_from_is_one_sentence(
    source: Source, tmp_path: Path, change: Callable[[State], object]
) -> None:
    states = list(source.episodes[0][:10])
    states[3] = changed(states[3], change)
    path = recorded.write(tmp_path, source.world, states)
    with pytest.raises(InvalidInput) as raised:
        read_one(path)
    assert str(path) in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_place_that_cannot_be_written_is_one_sentence(folder: Path) -> None:
    with pytest.raises(Conflict):
        write_robomimic(choose(list_paths([folder]), EpisodeFilter()), folder / "nowhere" / "lifting.hdf5")


def test_idle_time_is_left_out_of_an_export(folder: Path) -> None:
    episode = min(folder.rglob("*.mcap"))
    last = len(open_episode(episode).arrays()) - 1
    write(folder, folder / "all.hdf5", "--control-hz", "own")
    write(folder, folder / "moving.hdf5", "--control-hz", "own", "--skip-idle", "0.2")
    with h5py.File(folder / "all.hdf5") as whole, h5py.File(folder / "moving.hdf5") as moving:
        assert len(whole["data/demo_0/actions"]) == last + 1
        assert 0 < len(moving["data/demo_0/actions"]) < last + 1
