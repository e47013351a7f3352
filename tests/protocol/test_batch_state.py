"""Batches of worlds, packed and unpacked."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mart.protocol import codec
from mart.protocol.batch_state import BatchState, join, pack, pack_actions, unpack
from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import WorldArrays
from mart.protocol.tasks import get_task

TASK = get_task("two_arm_multi_cube_lifting")


@st.composite
def batches(draw: st.DrawFn) -> BatchState:
    count = draw(st.integers(1, 5))

    def some(shape: tuple[int, ...], dtype: Any = np.float64) -> Any:
        return draw(arrays(dtype, (count, *shape)))

    reasons = tuple(draw(st.sampled_from(["", "A cube fell off the table."])) for _ in range(count))
    return BatchState(
        observations={observation.name: some(observation.shape) for observation in TASK.observations},
        subtasks=some((len(TASK.subtasks),), np.bool_),
        success=some((), np.bool_),
        failed=np.array([bool(reason) for reason in reasons]),
        sim_time_s=some(()),
        success_ticks=some((), np.uint32),
        reasons=reasons,
        integration_states=draw(st.none() | arrays(np.float64, (count, 3))),
    )


def arrays_of(worlds: BatchState) -> dict[str, Any]:
    """As bytes: NaN is equal to itself."""
    packed = {name: np.asarray(value) for name, value in vars(worlds).items() if name != "observations"}
    packed |= worlds.observations
    return {
        name: (value.shape, value.tolist() if value.dtype == object else value.tobytes())
        for name, value in packed.items()
    }


@settings(max_examples=15)
@given(batches())
def test_a_batch_survives_the_wire(worlds: BatchState) -> None:
    message = codec.decode(WorldArrays, codec.encode(pack(worlds)))
    assert arrays_of(unpack(TASK, message, len(worlds.reasons))) == arrays_of(worlds)


@settings(max_examples=15)
@given(batches())
def test_halves_join_to_the_whole(worlds: BatchState) -> None:
    one_by_one = [
        BatchState(
            observations={name: value[i : i + 1] for name, value in worlds.observations.items()},
            subtasks=worlds.subtasks[i : i + 1],
            success=worlds.success[i : i + 1],
            failed=worlds.failed[i : i + 1],
            sim_time_s=worlds.sim_time_s[i : i + 1],
            success_ticks=worlds.success_ticks[i : i + 1],
            reasons=worlds.reasons[i : i + 1],
            integration_states=None
            if worlds.integration_states is None
            else worlds.integration_states[i : i + 1],
        )
        for i in range(len(worlds.reasons))
    ]
    assert arrays_of(join(one_by_one)) == arrays_of(worlds)


@settings(max_examples=15)
@given(batches(), st.sampled_from(["observations", "subtasks", "success_ticks", "success", "sim_time_s"]))
def test_an_array_of_another_size_is_corrupt(worlds: BatchState, field: str) -> None:
    message = pack(worlds)
    setattr(message, field, getattr(message, field) + b"\0")
    with pytest.raises(Corrupt, match=field):
        unpack(TASK, message, len(worlds.reasons))


@settings(max_examples=15)
@given(batches())
def test_another_number_of_worlds_is_corrupt(worlds: BatchState) -> None:
    with pytest.raises(Corrupt, match="worlds were answered"):
        unpack(TASK, pack(worlds), len(worlds.reasons) + 1)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1.001, -2.0])
def test_actions_that_cannot_be_are_refused(bad: float) -> None:
    actions = np.zeros((2, 2, 7))
    actions[1, 0, 6] = bad
    with pytest.raises(InvalidInput, match="every number must be"):
        pack_actions(actions, (2, 2, 7))


def test_actions_of_another_shape_are_refused() -> None:
    with pytest.raises(InvalidInput, match=r"\(2, 14\) were given; \(2, 2, 7\) is needed"):
        pack_actions(np.zeros((2, 14)), (2, 2, 7))


def test_rounding_may_lead_a_little_beyond_one() -> None:
    assert pack_actions(np.full((1, 2, 7), 1 + 1e-9), (1, 2, 7)).dtype == "<f8"
