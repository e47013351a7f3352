"""Updates of BC-RNN and HBC: ours beside robomimic's on the same data, and five seeds in one step beside one by one.

Episodes of scripted experts are recorded and exported as robomimic's HDF5; robomimic reads that file, we read the
episodes. Both have the same networks (LSTM 2 x 400; VAE 1024, 1024 with latent 16 and a learned prior of ten modes),
batch (100 sequences of 10), Adam with the same rate, and observations as they are. They take turns, block by block, on
every core. robomimic computes in float32; we in bfloat16 where the processor has it, as `mart train` does by default.
What an update takes is all of it: batch, gradient, step and log.

On a GPU: how long all seven models of the paper take, five seeds each, at their published sizes. It follows from the
rate of their updates; residuals are taken to learn as fast as their bases.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import torch
from report import Bar, report, spread
from support.robomimic import Updates, robomimic

from mart.trainer.data.data_spec import Selection
from mart.trainer.data.dataset import Dataset, load_dataset
from mart.trainer.data.windows import Windows
from mart.trainer.models.architecture import PAPER, ModelSpec
from mart.trainer.models.devices import find_device, product_dtype
from mart.trainer.models.networks import Networks, window_spec
from mart.trainer.train.presets import preset
from mart.trainer.train.training_loop import TrainingLoop, training_phases

TASK = "two_arm_multi_cube_lifting"
EPISODES = 8
ALGORITHMS = {"BC-RNN": "bc", "HBC": "hbc"}
BLOCKS = 8
UPDATES = 15  # a block
SEEDS = 5
SEED_BLOCKS = 4
SEED_UPDATES = 3
GPU_UPDATES = 200
WHEN = ("in_first_block", "in_last_block")

# Our name of a loss: robomimic's.
LOSSES = {
    "BC-RNN": {"actor": "Loss"},
    "HBC": {"actor": "Actor/Loss", "reconstruction": "Planner/Reconstruction_Loss"},
}


@dataclass(frozen=True)
class Block:
    """Some updates: how long they took, and means over them by name."""

    took_s: float
    losses: dict[str, float]


class Training:
    """One of our models as `mart train` trains it, for some seeds at once; observations as they are."""

    def __init__(self, name: str, dataset: Dataset, seeds: Sequence[int], on: str = "cpu") -> None:
        model, device = ModelSpec.parse(name), find_device(on)
        sizes = preset("paper").model_copy(update={"normalise": False})
        self.dtype = product_dtype(device)
        networks = Networks(model, dataset.layout, sizes, seeds, self.dtype).to(device)
        obs = networks.normaliser(torch.from_numpy(dataset.observations).to(device))
        windows = Windows(dataset, obs, None, window_spec(model, sizes), device)
        phases = training_phases(networks, sizes, has_base=False)
        self._loop = TrainingLoop(networks, windows, phases, sizes, seeds=seeds, dtype=self.dtype)
        self.parameters = sum(weight.numel() for weight in networks.parameters())
        self.windows = windows.count

    def update(self, number: int) -> Block:
        begun_s = time.perf_counter()
        sums: dict[str, float] = defaultdict(float)
        for _ in range(number):
            losses = self._loop.update()
            for name, value in (losses.terms | losses.diagnostics).items():
                sums[name] += float(value.detach().mean()) / number
        return Block(time.perf_counter() - begun_s, dict(sums))


@dataclass(frozen=True)
class Compared:
    ours: list[Block]
    theirs: list[Updates]
    training: Training

    @property
    def times_faster(self) -> list[float]:
        """Of every block."""
        return [their.took_s / our.took_s for our, their in zip(self.ours, self.theirs, strict=True)]


def main() -> None:
    metrics: dict[str, Any] = {"updates": BLOCKS * UPDATES}
    peer: dict[str, Any] = {}
    bars = []
    with tempfile.TemporaryDirectory() as folder:
        dataset, file = episodes(Path(folder))
        for name in ALGORITHMS:
            compared = compare(name, dataset, file)
            metrics |= {"precision": str(compared.training.dtype), **of_ours(name, compared)}
            metrics |= spread(f"{name}_{SEEDS}_seeds_at_once_times_one_by_one", at_once(name, dataset))
            peer |= {"name": f"robomimic {compared.theirs[0].version}", **of_theirs(name, compared)}
            bars += judged(name, compared)
        metrics |= on_gpu(dataset)
    report("train", metrics, peer, bars)


def episodes(folder: Path) -> tuple[Dataset, Path]:
    """Of scripted experts: as we read them, and the file that robomimic reads."""
    file, collected = folder / "episodes.hdf5", folder / "collected"
    mart("collect", "--lockstep", "--task", TASK, "--episodes", EPISODES, "--seed", 0, "--out", collected)
    mart("episodes", "export", "--format", "robomimic", "--out", file, collected)
    return load_dataset([collected], Selection()), file


def mart(*arguments: object) -> None:
    command = [str(Path(sys.executable).with_name("mart")), *map(str, arguments)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def compare(name: str, dataset: Dataset, file: Path) -> Compared:
    """In turns; the first update of both is not counted."""
    training = Training(name, dataset, [0])
    ours, theirs = [], []
    with robomimic(file, ALGORITHMS[name]) as peer:
        training.update(1)
        assert peer.update(1).windows == training.windows
        for _ in range(BLOCKS):
            ours.append(training.update(UPDATES))
            theirs.append(peer.update(UPDATES))
    return Compared(ours, theirs, training)


def at_once(name: str, dataset: Dataset) -> list[float]:
    """How many times faster some seeds learn in one step than each in a step of its own, block by block."""
    stacked = Training(name, dataset, range(SEEDS))
    single = [Training(name, dataset, [seed]) for seed in range(SEEDS)]
    for training in (stacked, *single):
        training.update(1)
    ratios = []
    for _ in range(SEED_BLOCKS):
        one_by_one_s = sum(training.update(SEED_UPDATES).took_s for training in single)
        ratios.append(one_by_one_s / stacked.update(SEED_UPDATES).took_s)
    return ratios


def on_gpu(dataset: Dataset) -> dict[str, float]:
    """Hours of the published number of updates, by model and in all; nothing where there is no GPU."""
    if not torch.cuda.is_available():
        print("The seven models at their published sizes need a GPU, and there is none here: not measured.")
        return {}
    updates, hours = preset("paper").updates, {}
    for name in PAPER:
        training = Training(name, dataset, range(SEEDS), on="cuda")
        training.update(1)
        took_s = training.update(GPU_UPDATES).took_s
        hours[f"{name}_{SEEDS}_seeds_on_gpu_h"] = took_s / GPU_UPDATES * updates / 3600
    return {**hours, f"all_models_{SEEDS}_seeds_on_gpu_h": sum(hours.values())}


def of_ours(name: str, compared: Compared) -> dict[str, float]:
    ends = (compared.ours[0].losses, compared.ours[-1].losses)
    return {
        f"{name}_parameters": compared.training.parameters,
        **rates(name, [block.took_s for block in compared.ours]),
        **spread(f"{name}_times_robomimic", compared.times_faster),
        **{
            f"{name}_{part}_loss_{when}": of[part]
            for part in LOSSES[name]
            for when, of in zip(WHEN, ends, strict=True)
        },
    }


def of_theirs(name: str, compared: Compared) -> dict[str, float]:
    ends = (compared.theirs[0].losses, compared.theirs[-1].losses)
    return {
        f"{name}_parameters": compared.theirs[0].parameters,
        **rates(name, [block.took_s for block in compared.theirs]),
        **{
            f"{name}_{part}_loss_{when}": of[theirs]
            for part, theirs in LOSSES[name].items()
            for when, of in zip(WHEN, ends, strict=True)
        },
    }


def rates(name: str, took_s: list[float]) -> dict[str, float]:
    return spread(f"{name}_updates_per_s", [UPDATES / seconds for seconds in took_s])


def judged(name: str, compared: Compared) -> list[Bar]:
    ours, theirs = compared.ours[-1].losses, compared.theirs[-1].losses
    return [
        Bar.at_least(f"{name}: times robomimic's updates", median(compared.times_faster), 3.0),
        *(
            Bar.at_most(f"{name}: {part} loss, times robomimic's", ours[part] / theirs[their], 1.1)
            for part, their in LOSSES[name].items()
        ),
    ]


if __name__ == "__main__":
    main()
