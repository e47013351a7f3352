"""A trained model in seats: its parts, each with a memory of its own, act as the whole does."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest

from mart.trainer.models.policies.load import load_policy
from mart.trainer.serve.policy_operator import parts_of
from mart.trainer.train.run_directory import RunDirectory
from mart.trainer.train.spec import TrainingSpec
from mart.trainer.train.training import train
from tests.trainer.conftest import Recorded


def checkpoint(episodes: Recorded, root: Path, model: str) -> Path:
    changes = {"updates": 3, "checkpoints": 1}
    request = TrainingSpec(model=model, data=(episodes.root,), preset="debug", changes=changes)
    train(request, root, threading.Event(), lambda _: None)
    run = RunDirectory(root)
    return run.checkpoint(run.checkpointed()[-1], 0)


@pytest.mark.parametrize(("model", "parts"), [("d-BC-RNN", 2), ("BC-RNN", 1), ("rd-HBC", 1)])
def test_the_parts_act_as_the_whole(episodes: Recorded, tmp_path: Path, model: str, parts: int) -> None:
    path = checkpoint(episodes, tmp_path, model)
    whole, apart = load_policy(path), parts_of(load_policy(path))
    assert len(apart) == parts
    for policy in (whole, *apart):
        policy.begin(1, 7)
    for state in episodes.states[0][:15]:
        seen = {o.name: np.array(o.value) for o in state.observations}
        shaped = {s.name: seen[s.name].reshape(1, *s.shape) for s in whole.layout.fields}
        together = np.concatenate([policy.act(shaped) for policy in apart], axis=1)
        np.testing.assert_allclose(together, whole.act(shaped), atol=1e-6)
