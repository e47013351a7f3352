"""What is learned: our BC-RNN and HBC beside robomimic's, from the same episodes, judged in the same worlds.

Average scripts record episodes, which robomimic reads as HDF5 and we as they are; both learn from the successful ones.
Both have the networks, batch and number of updates of our preset `fast`; everything else is each one's own way:
robomimic's tuned settings (constant rate 1e-3, observations as they are), our preset's. Each seed's last policy plays
in worlds that neither has seen.
"""

from __future__ import annotations

import contextlib
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from report import Bar, report
from support.robomimic import robomimic_policy

from mart.protocol.tasks import get_task
from mart.rollouts.client import RolloutClient
from mart.rollouts.replicas import worlds
from mart.trainer.evaluate.rollouts import roll_out
from mart.trainer.evaluate.statistics import Rate
from mart.trainer.evaluate.world_seeds import Purpose, world_seeds
from mart.trainer.models.policies.load import load_policy
from mart.trainer.models.policies.policy import Policy
from mart.trainer.train.presets import preset

TASK = "two_arm_multi_cube_lifting"
EPISODES = 100
SEEDS = 3
WORLDS = 100  # a seed
ALGORITHMS = {"BC-RNN": "bc", "HBC": "hbc"}


def main() -> None:
    metrics: dict[str, float] = {}
    peer: dict[str, object] = {}
    bars = []
    with tempfile.TemporaryDirectory() as folder, worlds(()) as client:
        data, file = episodes(Path(folder))
        for name in ALGORITHMS:
            ours = ours_judged(name, data, Path(folder) / name, client)
            version, theirs = theirs_judged(name, file, client)
            metrics |= in_figures(name, ours)
            peer |= {"name": f"robomimic {version}", **in_figures(name, theirs)}
            bars.append(
                Bar.at_least(
                    f"{name}: success, less robomimic's, in half intervals", lead(ours, theirs), -1.0
                )
            )
    report("learning", metrics, peer, bars)


def episodes(folder: Path) -> tuple[Path, Path]:
    """Of average scripts: as we read them, and the file that robomimic reads."""
    file, data = folder / "episodes.hdf5", folder / "collected"
    options = ["--skill", "average", "--episodes", str(EPISODES), "--seed", "0", "--out", str(data)]
    mart("collect", "--lockstep", "--task", TASK, *options)
    mart("episodes", "export", "--format", "robomimic", "--out", str(file), str(data))
    return data, file


def ours_judged(name: str, data: Path, run: Path, client: RolloutClient) -> Rate:
    seeds = range(SEEDS)
    mart(
        "train",
        "--model",
        name,
        "--data",
        str(data),
        "--seeds",
        str(SEEDS),
        "--preset",
        "fast",
        "--out",
        str(run),
    )
    updates = preset("fast").updates
    return judged(
        [load_policy(run / "checkpoints" / str(updates) / f"seed-{seed}") for seed in seeds], client
    )


def theirs_judged(name: str, file: Path, client: RolloutClient) -> tuple[str, Rate]:
    """robomimic's version, and what it achieves."""
    ours = preset("fast")
    sizes = {"batch": ours.batch_size, "lstm": ours.rnn_hidden, "vae": ours.vae_hidden}
    with contextlib.ExitStack() as stack:
        policies = [
            stack.enter_context(
                robomimic_policy(
                    file, ALGORITHMS[name], get_task(TASK), seed=seed, updates=ours.updates, sizes=sizes
                )
            )
            for seed in range(SEEDS)
        ]
        return policies[0].version, judged(policies, client)


def judged(policies: Sequence[Policy], client: RolloutClient) -> Rate:
    rollouts = roll_out(policies, client, world_seeds(Purpose.SCORE, 0, WORLDS), policy_seed=0)
    succeeded = [rollout.result.succeeded for of_policy in rollouts for rollout in of_policy]
    return Rate(sum(succeeded), len(succeeded))


def lead(ours: Rate, theirs: Rate) -> float:
    """How far ours is ahead, in halves of the 95 % interval of the difference; -1: just as bad as chance allows."""
    halves = [np.subtract(*rate.interval[::-1]) / 2 for rate in (ours, theirs)]
    return (ours.value - theirs.value) / float(np.hypot(*halves))


def in_figures(name: str, rate: Rate) -> dict[str, float]:
    low, high = rate.interval
    return {f"{name}_success": rate.value, f"{name}_success_low": low, f"{name}_success_high": high}


def mart(*arguments: str) -> None:
    command = [str(Path(sys.executable).with_name("mart")), *arguments]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    main()
