"""Windows never leave their episode, and repeat its ends."""

from __future__ import annotations

import numpy as np
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.trainer.data.data_spec import Selection
from mart.trainer.data.dataset import DataDigest, Dataset, join
from mart.trainer.data.episode import EpisodeArrays
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.data.windows import Windows, WindowSpec

LAYOUT = ObservationLayout.of_arms("two_arm_multi_cube_lifting", 2)
CPU = torch.device("cpu")


def _dataset(lengths: list[int]) -> Dataset:
    """The first number of an observation and of an action says which state or tick it is: 100 e + t."""
    episodes = []
    for e, ticks in enumerate(lengths):
        observations = np.zeros((ticks + 1, LAYOUT.width), np.float32)
        observations[:, 0] = 100 * e + np.arange(ticks + 1)
        actions = np.zeros((ticks, 2, 7), np.float32)
        actions[:, :, 0] = 100 * e + np.arange(ticks)[:, None]
        episodes.append(EpisodeArrays(observations, actions, np.ones((ticks, 2), np.int8)))
    digest = DataDigest(
        task="", control_hz=20, arms=LAYOUT.arms, selection=Selection(), episodes=(), ticks=0, sha256=""
    )
    return join(digest, LAYOUT, episodes)


def _windows(dataset: Dataset, shape: WindowSpec) -> Windows:
    return Windows(dataset, torch.from_numpy(dataset.observations), None, shape, CPU)


@settings(max_examples=30)
@given(st.lists(st.integers(1, 15), min_size=1, max_size=5), st.integers(1, 12))
def test_sequences_are_gathered_and_padded_as_robomimic_does(lengths: list[int], ticks: int) -> None:
    windows = _windows(_dataset(lengths), WindowSpec.sequence(ticks))
    starts = [(e, t) for e, length in enumerate(lengths) for t in range(length)]
    assert windows.count == len(starts)
    batch = windows.take(torch.arange(windows.count)[None])
    for i, (e, t) in enumerate(starts):
        last = lengths[e] - 1
        expected = [100 * e + min(t + k, last) for k in range(ticks)]
        assert batch.obs[0, :, i, 0].tolist() == expected
        assert batch.actions[0, :, i, 1, 0].tolist() == expected
        assert batch.goal[0, i, 0] == 100 * e + min(t + ticks, lengths[e])


@settings(max_examples=30)
@given(st.lists(st.integers(1, 15), min_size=1, max_size=5), st.integers(1, 12))
def test_chunks_look_one_tick_back(lengths: list[int], ticks: int) -> None:
    windows = _windows(_dataset(lengths), WindowSpec.chunk(ticks))
    batch = windows.take(torch.arange(windows.count)[None])
    starts = [(e, t) for e, length in enumerate(lengths) for t in range(length)]
    for i, (e, t) in enumerate(starts):
        assert batch.obs[0, :, i, 0].tolist() == [100 * e + max(t - 1, 0), 100 * e + t]
        expected = [100 * e + min(t + k, lengths[e] - 1) for k in range(ticks)]
        assert batch.actions[0, :, i, 0, 0].tolist() == expected


def test_each_seed_takes_its_own() -> None:
    windows = _windows(_dataset([5, 5]), WindowSpec.sequence(2))
    batch = windows.take(torch.tensor([[0, 1], [7, 8]]))
    assert batch.obs[:, 0, :, 0].tolist() == [[0, 1], [102, 103]]
