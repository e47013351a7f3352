"""Training as a function: it learns, it goes on exactly, and whatever stops it leaves nothing torn."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import load_file
from torch import Tensor

from mart.protocol.errors import Conflict, InvalidInput, NotFound, Unavailable
from mart.trainer.data.data_spec import Selection
from mart.trainer.models.checkpoint import WEIGHTS, read_record
from mart.trainer.train.progress import TrainingProgress
from mart.trainer.train.run_directory import RunDirectory
from mart.trainer.train.spec import TrainingSpec
from mart.trainer.train.training import train
from tests.trainer.conftest import Recorded


def request(episodes: Recorded, model: str = "r-HBC", **changes: object) -> TrainingSpec:
    fields = {"seeds": (0, 1), "preset": "debug", "data": (episodes.root,)} | changes
    return TrainingSpec.model_validate({"model": model, **fields})


def run(request: TrainingSpec, folder: Path, stop_after: int | None = None) -> list[TrainingProgress]:
    stop, made = threading.Event(), []

    def look(progress: TrainingProgress) -> None:
        made.append(progress)
        if progress.updates == stop_after:
            stop.set()

    train(request, folder, stop, look)
    return made


def weights(folder: Path, seed: int = 0) -> dict[str, Tensor]:
    found = RunDirectory(folder)
    return load_file(found.checkpoint(found.checkpointed()[-1], seed) / WEIGHTS)


def same(one: dict[str, Tensor], other: dict[str, Tensor]) -> bool:
    return one.keys() == other.keys() and all(torch.equal(one[name], other[name]) for name in one)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "changes"),
    [
        ("r-HBC", {"weight_decay": 0.01}),
        ("rd-HBC", {"one_arm_share": 0.5, "observation_noise": 0.1, "residual_subgoal": "prior"}),
        ("none/joint/joint/mlp/gmm", {}),
        ("r-Flow", {"normalise_actions": True}),
        ("d-MIP", {"normalise_actions": True}),
        ("d-Diffusion", {}),
        ("none/joint/per-arm/act", {}),
    ],
)
@pytest.mark.parametrize("ema", [None, 0.9])
def test_stopped_and_resumed_is_the_same_bit_for_bit(
    episodes: Recorded, tmp_path: Path, model: str, changes: dict[str, object], ema: float | None
) -> None:
    asked = request(episodes, model, changes=changes | {"ema": ema, "schedule": "cosine"})
    whole = run(asked, tmp_path / "whole")
    for stop_after in (
        7,
        15,
        20,
        22,
    ):  # within the base, at a checkpoint, where the residual begins, within it
        run(asked, tmp_path / "parts", stop_after)
    run(asked, tmp_path / "parts")
    for seed in asked.seeds:
        assert same(weights(tmp_path / "whole", seed), weights(tmp_path / "parts", seed))
    rows = (tmp_path / "parts" / "metrics.jsonl").read_text().splitlines()
    assert [json.loads(row)["updates"] for row in rows] == [progress.updates for progress in whole]


def test_a_run_that_is_over_stays_as_it_is(episodes: Recorded, tmp_path: Path) -> None:
    asked = request(episodes)
    run(asked, tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.safetensors")}
    assert run(asked, tmp_path) == []
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.safetensors")} == before


def test_the_run_tells_what_it_is(episodes: Recorded, tmp_path: Path) -> None:
    asked = request(episodes, seeds=(3, 9))
    run(asked, tmp_path)
    found = RunDirectory(tmp_path)
    assert found.spec == asked
    assert found.checkpointed() == (15, 30)
    assert found.seeds(30) == (3, 9)
    record = read_record(found.checkpoint(15, 9))
    assert (record.name, record.seed, record.updates) == ("r-HBC", 9, 15)
    assert record.data_sha256 == json.loads(found.data.read_bytes())["sha256"]
    last = json.loads(found.metrics.read_text().splitlines()[-1])
    assert (last["updates"], last["updates_in_all"], last["stage"]) == (30, 30, "residual")
    assert last["loss"] == last["loss/residual"]
    assert next(found.tensorboard.iterdir()).name.startswith("events.out.tfevents")


def test_weights_are_kept_under_names_that_old_checkpoints_have(episodes: Recorded, tmp_path: Path) -> None:
    run(request(episodes, "r-HBC"), tmp_path / "hierarchy")
    run(request(episodes, "Flow"), tmp_path / "flow")
    planner = {f"model.planner.{part}" for part in ("encoder", "decoder", "prior")}
    expected = {*planner, "model.actor.body", "model.actor.head", "model.residual.net"}
    for name, parts in (("hierarchy", expected), ("flow", {"model.flow.net"})):
        names = {name.rpartition(".layers.")[0] or name for name in weights(tmp_path / name)}
        found = {".".join(name.split(".")[:3]) for name in names}
        assert found == parts | {"normaliser.mean", "normaliser.deviation"}
    actor = {name for name in weights(tmp_path / "hierarchy") if name.startswith("model.actor.")}
    lstm = {f"model.actor.body.lstm.{name}.{layer}" for name in ("w_i", "w_h", "b") for layer in (0, 1)}
    assert actor == lstm | {"model.actor.head.out.weight", "model.actor.head.out.bias"}


def test_stacked_seeds_learn_what_they_would_alone(episodes: Recorded, tmp_path: Path) -> None:
    changes = {"precision": "float32"}
    run(request(episodes, "d-HBC", seeds=(4, 5, 6), changes=changes), tmp_path / "stacked")
    run(request(episodes, "d-HBC", seeds=(5,), changes=changes), tmp_path / "alone")
    stacked, alone = weights(tmp_path / "stacked", 5), weights(tmp_path / "alone", 5)
    for name, value in alone.items():
        torch.testing.assert_close(stacked[name], value, atol=2e-4, rtol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("model", ["d-HBC", "BC", "Flow", "MIP"])
def test_two_episodes_are_learned_by_heart(episodes: Recorded, tmp_path: Path, model: str) -> None:
    changes = {
        "updates": 300, "learning_rate": 1e-2, "schedule": "cosine", "checkpoints": 1, "batch_size": 32,
        "rnn_hidden": 24, "mlp_hidden": [64, 64], "vae_hidden": [32], "chunk_hidden": [128, 128],
    }  # fmt: skip
    asked = request(episodes, model, seeds=(0,), changes=changes, selection=Selection(first=2))
    losses = [progress.losses["loss/actor"] for progress in run(asked, tmp_path)]
    assert np.mean(losses[-20:]) < 0.12 * np.mean(losses[:3])


def test_a_base_that_is_there_is_not_trained_again(episodes: Recorded, tmp_path: Path) -> None:
    run(request(episodes, "d-HBC", seeds=(0, 1, 2)), tmp_path / "base")
    base = tmp_path / "base"
    made = run(request(episodes, "r-HBC", seeds=(1, 2), base=base), tmp_path / "residual")
    assert {progress.phase for progress in made} == {"residual"}
    assert made[-1].updates_in_all == 10
    corrected, theirs = weights(tmp_path / "residual", 2), weights(base, 2)
    assert same({name: corrected[name] for name in theirs}, theirs)
    checkpoint = RunDirectory(base).checkpoints / "10"
    run(request(episodes, "r-HBC", seeds=(0,), base=checkpoint), tmp_path / "earlier")
    with pytest.raises(InvalidInput):
        run(request(episodes, "rd-HBC", base=base), tmp_path / "wrong")
    with pytest.raises(InvalidInput):
        run(request(episodes, "d-HBC", base=base), tmp_path / "none")
    with pytest.raises(NotFound):
        run(request(episodes, "r-HBC", seeds=(7,), base=base), tmp_path / "unknown seed")
    with pytest.raises(InvalidInput):
        run(request(episodes, "r-HBC", base=tmp_path), tmp_path / "no run")


def test_weights_by_source(episodes: Recorded, tmp_path: Path) -> None:
    plain, weighed = request(episodes, "BC"), request(episodes, "BC", weights={"human": 5.0})
    run(plain, tmp_path / "plain")
    run(weighed, tmp_path / "weighed")
    assert same(weights(tmp_path / "plain"), weights(tmp_path / "weighed"))  # nobody but scripts drove
    with pytest.raises(InvalidInput):
        run(request(episodes, "BC", weights={"script": 0.0}), tmp_path / "nothing")


def test_a_loss_that_diverges_stops_and_keeps_what_was_good(episodes: Recorded, tmp_path: Path) -> None:
    changes = {"learning_rate": 1e18, "updates": 40, "checkpoints": 40, "precision": "float32"}
    asked = request(episodes, "HBC", seeds=(0,), changes=changes)
    with pytest.raises(InvalidInput, match=r"is no number any more after .* smaller learning_rate"):
        run(asked, tmp_path)
    found = RunDirectory(tmp_path)
    for updates in found.checkpointed():
        kept = load_file(found.checkpoint(updates, 0) / WEIGHTS)
        assert all(torch.isfinite(value).all() for value in kept.values())


def test_what_cannot_be_asked_is_refused(episodes: Recorded, tmp_path: Path) -> None:
    run(request(episodes), tmp_path / "run")
    with pytest.raises(Conflict):
        run(request(episodes, "HBC"), tmp_path / "run")
    with pytest.raises(NotFound):
        run(request(episodes, "rdHBC"), tmp_path / "a")
    with pytest.raises(InvalidInput):
        run(request(episodes, "joint/joint/none/flow"), tmp_path / "b")
    with pytest.raises(NotFound):
        run(request(episodes, preset="slow"), tmp_path / "c")
    with pytest.raises(InvalidInput):
        run(request(episodes, changes={"batch_size": 0}), tmp_path / "d")
    with pytest.raises(InvalidInput):
        run(request(episodes, changes={"bach_size": 3}), tmp_path / "e")
    for model in ("Flow", "BC-RNN-GMM"):
        with pytest.raises(InvalidInput, match="one_arm_share"):
            run(request(episodes, model, changes={"one_arm_share": 0.5}), tmp_path / "g")
    with pytest.raises(Unavailable):
        run(request(episodes, device=f"cuda:{torch.cuda.device_count() + 3}"), tmp_path / "f")


def test_data_that_changed_are_noticed(episodes: Recorded, tmp_path: Path) -> None:
    data = tmp_path / "episodes"
    shutil.copytree(episodes.root, data)
    asked = request(episodes, data=(data,))
    run(asked, tmp_path / "run", stop_after=5)
    next(data.rglob("*.mcap")).unlink()
    with pytest.raises(Conflict):
        run(asked, tmp_path / "run")


def test_one_process_at_a_time(episodes: Recorded, tmp_path: Path) -> None:
    def again(_: TrainingProgress) -> None:
        with pytest.raises(Conflict):
            train(request(episodes), tmp_path, threading.Event(), print)

    train(request(episodes), tmp_path, threading.Event(), again)


_KILLED = """
import os, signal, sys, threading
from pathlib import Path
from mart.trainer.train import run_checkpoints, run_directory, training
spec = run_directory.RunDirectory(Path(sys.argv[1])).spec
at, count = int(sys.argv[2]), 0
sync = os.fsync
def fsync(handle):
    global count
    count += 1
    if count == at:
        os.kill(os.getpid(), signal.SIGKILL)
    sync(handle)
os.fsync = fsync
training.train(spec, Path(sys.argv[1]), threading.Event(), lambda _: None)
"""


@pytest.mark.system
@pytest.mark.parametrize("killed_at", [2, 9])
def test_killed_in_mid_checkpoint_nothing_torn_is_seen(
    episodes: Recorded, whole: dict[str, Tensor], tmp_path: Path, killed_at: int
) -> None:
    asked = request(episodes)
    run(asked, tmp_path, stop_after=5)
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    killed = subprocess.run(
        [sys.executable, "-c", _KILLED, str(tmp_path), str(killed_at)], env=environment, check=False
    )
    assert killed.returncode == -signal.SIGKILL
    found = RunDirectory(tmp_path)
    for updates in found.checkpointed():
        assert found.seeds(updates) == asked.seeds
        assert all(load_file(found.checkpoint(updates, seed) / WEIGHTS) for seed in asked.seeds)
    run(asked, tmp_path)
    assert same(weights(tmp_path), whole)
    assert not list(tmp_path.rglob("*.half"))


@pytest.fixture(scope="module")
def whole(episodes: Recorded, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Tensor]:
    folder = tmp_path_factory.mktemp("whole")
    run(request(episodes), folder)
    return weights(folder)
