"""Chunks as they are done: which of their actions, when a new one is drawn, and what several say of one tick."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch

from mart.protocol.errors import InvalidInput
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.checkpoint import CheckpointRecord
from mart.trainer.models.hyperparameters import Hyperparameters
from mart.trainer.models.layers.chunks import ChunkDenoiser
from mart.trainer.models.networks import Networks, tool_targets
from mart.trainer.models.policies.chunked import ChunkedPolicy
from mart.trainer.train.presets import PRESETS

TASK = "two_arm_multi_cube_lifting"
LAYOUT = ObservationLayout.of_arms(TASK, 2)
CPU = torch.device("cpu")


def policy(name: str = "MIP", **changes: float | str) -> ChunkedPolicy:
    sizes = Hyperparameters.model_validate(PRESETS["debug"].model_dump() | changes)
    model = ModelSpec.parse(name)
    record = CheckpointRecord(
        name=model.name,
        model=model,
        task=TASK,
        control_hz=20,
        arms=LAYOUT.arms,
        layout=LAYOUT.fields,
        hyperparameters=sizes,
        seed=0,
        updates=0,
        data_sha256="",
        versions={},
    )
    return ChunkedPolicy(record, Networks(model, LAYOUT, sizes, [0]), CPU)


def observations(seed: int, worlds: int = 1) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    found = {field.name: random.normal(size=(worlds, *field.shape)) for field in LAYOUT.fields}
    lengths = {name: np.linalg.norm(of, axis=-1, keepdims=True) for name, of in found.items()}
    return {name: of / lengths[name] if "quaternion" in name else of for name, of in found.items()}


def test_a_new_chunk_is_drawn_when_what_is_done_of_the_last_is_over() -> None:
    one, early = policy(chunk=6, chunk_execute=3), policy(chunk=6, chunk_execute=6)
    for each in (one, early):
        each.begin(1, 0)
    done, longer = (np.array([each.act(observations(t)) for t in range(6)]) for each in (one, early))
    np.testing.assert_array_equal(done[:3], longer[:3])
    assert not np.array_equal(done[3:], longer[3:])


def test_an_ensemble_averages_what_chunks_say_of_a_tick() -> None:
    alone = policy(chunk=3, chunk_execute=1)
    averaged = policy(chunk=3, chunk_ensemble=0.5)
    for each in (alone, averaged):
        each.begin(1, 0)
    chunks, done = [], []
    for t in range(5):
        alone.act(observations(t))
        chunks.append(alone._chunks[-1].numbers[0, :, 0].numpy())
        done.append(averaged.act(observations(t))[0])
    for t in range(5):
        first = max(0, t - 2)
        weights = [math.exp(-0.5 * i) for i in range(t - first + 1)]
        said = [weight * chunks[first + i][t - first - i] for i, weight in enumerate(weights)]
        np.testing.assert_allclose(done[t], sum(said) / sum(weights), atol=1e-5)


def test_absolute_targets_lead_back_to_where_a_chunk_began() -> None:
    """A network that answers 0 says: stay where you were. A tool that was moved goes back."""
    held = policy("d-MIP", chunk=6, chunk_execute=6, action_target="absolute")
    chunks = held._nets.chunks
    assert isinstance(chunks, ChunkDenoiser)
    chunks.net.last.zero()
    held.begin(1, 0)
    seen = observations(1)
    assert np.abs(held.act(seen)).max() < 1e-5
    moved = seen | {"arm1/tool_position_in_base": seen["arm1/tool_position_in_base"] + [0.02, 0, 0]}
    np.testing.assert_allclose(held.act(moved)[0, :, 0], [0, -0.4], atol=1e-5)


@pytest.mark.parametrize("name", ["BC-RNN", "r-Flow"])
def test_only_plain_models_of_chunks_have_absolute_targets(name: str) -> None:
    sizes = PRESETS["debug"].model_copy(update={"action_target": "absolute"})
    with pytest.raises(InvalidInput):
        tool_targets(ModelSpec.parse(name), sizes, TASK, LAYOUT, ())


def test_sizes_are_read_under_the_names_that_old_checkpoints_have() -> None:
    sizes = Hyperparameters.model_validate({"flow_chunk": 5, "flow_execute": 9, "flow_hidden": [8]})
    assert (sizes.chunk, sizes.executed, sizes.chunk_hidden) == (5, 5, (8,))
    with pytest.raises(ValueError, match="act_heads"):
        Hyperparameters(act_width=10, act_heads=4)
