"""Numbers stand where their names say, and what a policy gives is an action or an error."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.lerobot_policies import columns
from mart.protocol.errors import Corrupt, InvalidInput


@given(data=st.data(), worlds=st.integers(1, 4))
def test_each_number_is_the_named_one(data: st.DataObject, worlds: int) -> None:
    sizes = {"arm0/gripper": 1, "cube0/position_in_world": 3, "arm0/joint_positions": 7}
    every = [f"{name}/{index}" for name, size in sizes.items() for index in range(size)]
    names = data.draw(st.lists(st.sampled_from(every), min_size=1, unique=True))
    observations = {
        name: np.arange(worlds)[:, None] * 100.0 + 10 * order + np.arange(size)
        for order, (name, size) in enumerate(sizes.items())
    }
    found = columns.vector(names, observations)
    for column, name in enumerate(names):
        observation, _, index = name.rpartition("/")
        np.testing.assert_array_equal(found[:, column], observations[observation][:, int(index)])
    assert set(columns.observations_of(names)) == {name.rpartition("/")[0] for name in names}


@pytest.mark.parametrize("name", ["gripper", "/0", "arm0/gripper/", "arm0/gripper/-1", "arm0/gripper/²"])
def test_what_names_no_number_is_refused(name: str) -> None:
    with pytest.raises(Corrupt):
        columns.observations_of([name])


def test_what_is_not_shown_is_missed_by_name() -> None:
    with pytest.raises(InvalidInput, match="arm0/gripper/1"):
        columns.vector(["arm0/gripper/1"], {"arm0/gripper": np.zeros((1, 1))})
    with pytest.raises(InvalidInput, match="finite"):
        columns.vector(["arm0/gripper/0"], {"arm0/gripper": np.full((1, 1), np.nan)})


def test_actions_are_clipped_and_checked() -> None:
    given = np.linspace(-2, 2, 28, dtype=np.float32).reshape(2, 14)
    found = columns.actions(given, arms=2)
    assert found.shape == (2, 2, 7)
    assert (found.min(), found.max()) == (-1.0, 1.0)
    for bad in (given[:, :7], given[0], np.full((1, 14), np.inf)):
        with pytest.raises(Corrupt):
            columns.actions(bad, arms=2)
