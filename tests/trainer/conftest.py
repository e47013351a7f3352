"""Three recorded episodes of cube lifting, shared by all tests here."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
import torch

from mart.protocol.messages import State
from mart.sim.world import World
from mart.trainer.data.data_spec import Selection
from mart.trainer.data.dataset import Dataset, load_dataset
from tests.trainer import recorded


@dataclass(frozen=True)
class Recorded:
    """`root` holds one file for each of `states`, in their order."""

    root: Path
    world: World
    states: tuple[list[State], ...]


@pytest.fixture(scope="session")
def episodes(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    root, world = tmp_path_factory.mktemp("episodes"), World.build(recorded.TASK)
    performed = tuple(recorded.perform(world, seed, number=seed) for seed in (1, 2, 3))
    for states in performed:
        recorded.write(root, world, states)
    return Recorded(root, world, performed)


@pytest.fixture(scope="session")
def dataset(episodes: Recorded) -> Dataset:
    return load_dataset([episodes.root], Selection())


@pytest.fixture(autouse=True, scope="session")
def _own_data_dir(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setenv("MART_DATA_DIR", str(tmp_path_factory.mktemp("data")))
        yield


@pytest.fixture(autouse=True, scope="session")
def _one_thread() -> None:
    """Networks of a few neurons: threads would only wait for each other."""
    torch.set_num_threads(1)
