"""Episodes as arrays: what each row is, and what cannot be one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mart.episodes import EpisodeData, arrays_for_task, arrays_from_states, open_episode
from mart.episodes.edits import EpisodeEdits
from mart.episodes.labelled_episode import describe
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import OPERATOR_HOLD, OPERATOR_HUMAN, State
from mart.protocol.tasks import get_task
from tests.recorder import synthetic
from tests.recorder.files import write_episode
from tests.recorder.long_episode import write_long_episode

TICKS = 6


def observed_states() -> list[State]:
    """Of the toy room; each tick sees its own number, and a subtask is done from tick 4 on."""
    states = synthetic.states(TICKS)
    for tick, state in enumerate(states):
        state.observations.add(name="arm0/gripper", value=[float(tick)])
        state.observations.add(name="cube", value=[float(tick), 0.0, -float(tick)])
        state.progress.subtasks.add(name="lift", done=tick >= 4)
        state.progress.success = tick == TICKS
    return states


def data() -> EpisodeData:
    return arrays_from_states(observed_states())


def test_an_action_leads_from_its_row_to_the_next() -> None:
    assert data().actions.shape == (TICKS, 2, 7)
    for tick in range(1, TICKS + 1):
        for arm in (0, 1):
            np.testing.assert_array_equal(data().actions[tick - 1, arm], synthetic.action(tick, arm))
    np.testing.assert_array_equal(data().observations["arm0/gripper"][:, 0], np.arange(TICKS + 1))
    assert data().observations["cube"].shape == (TICKS + 1, 3)


def test_who_what_and_when() -> None:
    assert data().arms == synthetic.ARMS
    assert data().sources.tolist() == [[OPERATOR_HUMAN, OPERATOR_HOLD]] * TICKS
    assert data().subtasks["lift"].tolist() == [False] * 4 + [True] * 3
    assert data().success.tolist() == [False] * TICKS + [True]
    np.testing.assert_allclose(data().sim_time_s, 0.05 * np.arange(TICKS + 1))
    assert np.diff(data().sent_ns).tolist() == [synthetic.PERIOD_NS] * TICKS
    states = observed_states()
    assert data().integration_states[3].tobytes() == states[3].integration_state
    assert len(data()) == TICKS


def test_arms_and_observations_are_those_that_are_wanted() -> None:
    wanted = arrays_from_states(observed_states(), ("arm1", "arm0"), {"cube": (3, 1)})
    np.testing.assert_array_equal(wanted.actions, data().actions[:, ::-1])
    assert {name: values.shape for name, values in wanted.observations.items()} == {"cube": (TICKS + 1, 3, 1)}


def _without_a_tick(states: list[State]) -> None:
    del states[3]


def _with_one_state(states: list[State]) -> None:
    del states[1:]


@pytest.mark.parametrize(
    "damage",
    [
        _without_a_tick,
        _with_one_state,
        lambda states: states[3].arms.pop(),
        lambda states: states[3].arms[1].action.pop(),
        lambda states: states[3].arms[1].action.__setitem__(0, float("inf")),
        lambda states: states[3].observations.pop(),
        lambda states: states[3].observations[1].value.append(1.0),
        lambda states: states[3].observations[1].value.__setitem__(0, float("nan")),
        lambda states: setattr(states[3], "integration_state", b"short"),
    ],
)
def test_an_episode_that_is_not_whole_is_refused(damage: Callable[[list[State]], object]) -> None:
    states = observed_states()
    damage(states)
    with pytest.raises(InvalidInput):
        arrays_from_states(states)


def test_a_task_wants_all_that_its_catalogue_entry_names() -> None:
    with pytest.raises(InvalidInput):
        arrays_for_task(observed_states(), get_task(synthetic.TASK))


def test_a_file_that_is_not_whole_is_named(tmp_path: Path) -> None:
    """The toy room names a task of the catalogue, and sees nothing of it."""
    path = write_episode(tmp_path, ticks=5).path
    with pytest.raises(InvalidInput, match=path.name):
        open_episode(path).arrays()


def test_an_edited_episode_has_the_integration_states_of_the_ticks_that_are_left(tmp_path: Path) -> None:
    path = write_long_episode(tmp_path, minutes=0.01).path
    edits = EpisodeEdits().with_cut("3-5").with_skip("8-9")
    row = describe(path, path.name).model_copy(update={"edits": edits})
    states = [state.integration_state for state in open_episode(path).states()]
    for segment in row.segments():
        assert [one.tobytes() for one in segment.integration_states] == [
            states[tick] for tick in segment.ticks
        ]
