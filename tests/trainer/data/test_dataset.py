"""From episode files to arrays: aligned, selected, cached, and told exactly."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from mart.episodes import labels, open_episode
from mart.protocol.errors import Corrupt, InvalidInput, NotFound
from mart.protocol.messages import OPERATOR_HUMAN, OPERATOR_SCRIPT, OUTCOME_FAILURE, Operator, State
from mart.protocol.vocabulary import Verdict
from mart.trainer.data.data_spec import Selection
from mart.trainer.data.dataset import Dataset, load_dataset
from mart.trainer.data.episode import from_states
from tests.trainer import recorded
from tests.trainer.conftest import Recorded


def test_the_action_of_a_row_leads_from_its_state_to_the_next(episodes: Recorded, dataset: Dataset) -> None:
    """The file's states, stepped again with the data set's actions, give the data set's next observations."""
    world, row = episodes.world, 0
    for states in episodes.states:
        for t in range(0, len(states) - 1, 9):
            world.set_integration_state(states[t].integration_state)
            world.step(dataset.actions[row + t].astype(np.float64))
            seen = {name: value[None] for name, value in world.observations().items()}
            following = dataset.layout.vector(seen)[0]
            # Actions are float32 here; contacts make of their 6e-8 up to 2e-5, on one processor more than on another.
            np.testing.assert_allclose(dataset.observations[row + t + 1], following, atol=2e-4)
        row += len(states)


def test_what_is_used_is_told(episodes: Recorded, dataset: Dataset) -> None:
    digest = dataset.digest
    assert (digest.task, digest.control_hz, digest.arms) == (recorded.TASK, 20.0, ("arm0", "arm1"))
    assert [used.ticks for used in digest.episodes] == [len(states) - 1 for states in episodes.states]
    assert digest.ticks == len(dataset.starts)
    assert {used.operators for used in digest.episodes} == {("script expert",)}
    assert load_dataset([episodes.root], Selection()).digest == digest


def test_the_cache_says_the_same_and_mends_itself(
    episodes: Recorded, dataset: Dataset, tmp_path: Path
) -> None:
    for _ in range(2):
        again = load_dataset([episodes.root], Selection(), tmp_path)
        np.testing.assert_array_equal(again.observations, dataset.observations)
    entries = sorted(tmp_path.iterdir())
    assert len(entries) == 3
    entries[0].write_bytes(b"torn")
    mended = load_dataset([episodes.root], Selection(), tmp_path)
    np.testing.assert_array_equal(mended.actions, dataset.actions)


def test_what_people_cut_out_is_not_learned_from(
    episodes: Recorded, dataset: Dataset, tmp_path: Path
) -> None:
    root, cache = tmp_path / "episodes", tmp_path / "cache"
    shutil.copytree(episodes.root, root)
    first = min(root.rglob("*.mcap"))
    labels.say(first, labels.LabelKind.CUT, "10-14", 1)
    cut, from_cache = (load_dataset([root], Selection(), cache) for _ in range(2))
    for one in (cut, from_cache):
        assert (one.digest.ticks, one.digest.episodes[0].edits) == (dataset.digest.ticks - 4, "cut 10-14")
        assert one.ends[0] == 10
        np.testing.assert_array_equal(one.actions[11], dataset.actions[14])
        np.testing.assert_array_equal(one.observations[11], dataset.observations[14])
    assert cut.digest.sha256 != dataset.digest.sha256
    labels.say(first, labels.LabelKind.UNDO, "1", 2)
    whole = load_dataset([root], Selection(), cache)
    np.testing.assert_array_equal(whole.actions, dataset.actions)
    assert whole.digest.sha256 == dataset.digest.sha256


def test_first_and_last_are_by_time(episodes: Recorded) -> None:
    def ticks(selection: Selection) -> list[int]:
        return [used.ticks for used in load_dataset([episodes.root], selection).digest.episodes]

    lengths = [len(states) - 1 for states in episodes.states]
    assert ticks(Selection(first=2)) == lengths[:2]
    assert ticks(Selection(last=1)) == lengths[-1:]


def test_files_and_folders_may_overlap(episodes: Recorded, dataset: Dataset) -> None:
    twice = [episodes.root, *episodes.root.rglob("*.mcap")]
    assert load_dataset(twice, Selection()).digest == dataset.digest


def test_labels_overrule_files(episodes: Recorded, tmp_path: Path) -> None:
    root = tmp_path / "episodes"
    shutil.copytree(episodes.root, root)
    first, second, _ = sorted(root.rglob("*.mcap"))
    labels.say(first, labels.LabelKind.OUTCOME, "failure", 1)
    labels.say(second, labels.LabelKind.USE, "drop", 2)
    assert len(load_dataset([root], Selection()).digest.episodes) == 1
    both = load_dataset([root], Selection(outcomes=())).digest
    assert [used.outcome for used in both.episodes] == ["failure", "success"]


@pytest.mark.parametrize(
    "selection",
    [Selection(operators=("human",)), Selection(names=("novice",)), Selection(verdicts=("diverged",))],
    ids=["operators", "names", "verdicts"],
)
def test_nothing_left_says_what_there_was(episodes: Recorded, selection: Selection) -> None:
    with pytest.raises(InvalidInput, match=r"None of 3 episodes \(3 success; 3 verified; 0 dropped\)"):
        load_dataset([episodes.root], selection)


def test_selected_by_who_drove(episodes: Recorded) -> None:
    chosen = load_dataset([episodes.root], Selection(operators=("script",), names=("expert",)))
    assert len(chosen.digest.episodes) == 3


def test_no_data_is_said(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="There are no episodes"):
        load_dataset([tmp_path], Selection())
    with pytest.raises(NotFound, match="nowhere"):
        load_dataset([tmp_path / "nowhere"], Selection())


def test_episodes_that_do_not_belong_together_are_refused(episodes: Recorded, tmp_path: Path) -> None:
    states = episodes.states[0]
    recorded.write(tmp_path / "a", episodes.world, states)
    recorded.write(tmp_path / "b", episodes.world, states, control_hz=30.0)
    recorded.write(tmp_path / "c", episodes.world, states, task="two_arm_drink_tray_lifting")
    with pytest.raises(InvalidInput, match="several control rates were given: 20 Hz, 30 Hz"):
        load_dataset([tmp_path / "a", tmp_path / "b"], Selection())
    with pytest.raises(InvalidInput, match="several tasks were given"):
        load_dataset([tmp_path / "a", tmp_path / "c"], Selection())


def test_episodes_of_several_rates_are_learned_from_at_one(episodes: Recorded, tmp_path: Path) -> None:
    states = episodes.states[0]
    recorded.write(tmp_path, episodes.world, states)
    fine = recorded.write(tmp_path, episodes.world, episodes.states[1], control_hz=60.0)
    for _ in range(2):  # read, and from the cache
        mixed = load_dataset([tmp_path], Selection(), tmp_path / "cache", control_hz=20.0)
        told = open_episode(fine).arrays(control_hz=20.0)
        assert [(one.ticks, one.recorded_hz) for one in mixed.digest.episodes] == [
            (len(states) - 1, 20.0),
            (len(told), 60.0),
        ]
        assert mixed.digest.control_hz == 20.0
        rows = slice(len(states), None)
        np.testing.assert_array_equal(mixed.observations[rows], mixed.layout.vector(told.observations))
        np.testing.assert_allclose(mixed.actions[rows][:-1], told.actions, atol=1e-7)
        np.testing.assert_array_equal(mixed.sources[rows][:-1], told.sources)
    assert len(load_dataset([fine], Selection(), tmp_path / "cache").starts) == len(episodes.states[1]) - 1
    with pytest.raises(InvalidInput, match="at most 20 Hz"):
        load_dataset([tmp_path], Selection(), control_hz=60.0)


def test_failures_and_unverified_files_stay_out_unless_asked(episodes: Recorded, tmp_path: Path) -> None:
    states = episodes.states[0]
    recorded.write(tmp_path, episodes.world, states, outcome=OUTCOME_FAILURE)
    recorded.write(tmp_path, episodes.world, states, verdict=Verdict.UNVERIFIED)
    with pytest.raises(InvalidInput, match="widen it"):
        load_dataset([tmp_path], Selection())
    assert len(load_dataset([tmp_path], Selection(outcomes=(), verdicts=())).digest.episodes) == 2


def _without_arm(state: State) -> None:
    del state.arms[1]


def _with_nan(state: State) -> None:
    state.observations[0].value[0] = float("nan")


def _with_bad_action(state: State) -> None:
    state.arms[0].action[3] = float("inf")


def _without_observation(state: State) -> None:
    del state.observations[2]


def _later(state: State) -> None:
    state.episode_tick += 5


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (_without_arm, "has the arms arm0; all of arm0, arm1"),
        (_with_nan, "holds NaN or infinity"),
        (_with_bad_action, "an action holds NaN"),
        (_without_observation, "is missing"),
        (_later, "ticks are missing after tick 4"),
    ],
)
def test_states_that_cannot_be_learned_from_are_refused(
    episodes: Recorded, dataset: Dataset, damage: object, words: str
) -> None:
    states = [State.FromString(state.SerializeToString()) for state in episodes.states[0][:12]]
    assert callable(damage)
    damage(states[5])
    with pytest.raises(InvalidInput, match=words):
        from_states(dataset.layout, states)


def test_the_file_that_cannot_be_learned_from_is_named(episodes: Recorded, tmp_path: Path) -> None:
    states = [State.FromString(state.SerializeToString()) for state in episodes.states[0]]
    _with_nan(states[3])
    path = recorded.write(tmp_path, episodes.world, states)
    with pytest.raises(InvalidInput, match=path.name):
        load_dataset([tmp_path], Selection())


def test_a_damaged_file_is_corrupt(episodes: Recorded, tmp_path: Path) -> None:
    path = recorded.write(tmp_path, episodes.world, episodes.states[0])
    content = bytearray(path.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 400] = bytes(400)
    path.write_bytes(content)
    with pytest.raises(Corrupt, match="damaged"):
        load_dataset([tmp_path], Selection())


def test_a_file_that_cannot_be_read_is_left_out_and_said(
    episodes: Recorded, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    first = recorded.write(tmp_path, episodes.world, episodes.states[0])
    second = recorded.write(tmp_path, episodes.world, episodes.states[1])
    foreign = tmp_path / "real.mcap"
    foreign.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    data = bytearray(second.read_bytes())
    data[data.index(b"zstd") + 2000] ^= 1
    second.write_bytes(data)
    for paths in ([tmp_path], [first, second, foreign]):  # as a folder, and as a job names its files
        assert [used.path for used in load_dataset(paths, Selection()).digest.episodes] == [str(first)]
        assert f"Left out: {second} is damaged" in caplog.text
        assert f"Left out: {foreign} is an HDF5 file" in caplog.text
    with pytest.raises(Corrupt, match="an HDF5 file"):
        load_dataset([foreign], Selection())


def test_sources_are_by_tick(episodes: Recorded) -> None:
    def source(tick: int, arm: int) -> Operator:
        return OPERATOR_HUMAN if arm == 1 and tick > 20 else OPERATOR_SCRIPT

    states = recorded.perform(episodes.world, 4, source=source)
    arrays = from_states(load_dataset([episodes.root], Selection()).layout, states)
    assert (arrays.sources[:, 0] == OPERATOR_SCRIPT).all()
    assert (arrays.sources[:20, 1] == OPERATOR_SCRIPT).all()
    assert (arrays.sources[20:, 1] == OPERATOR_HUMAN).all()
