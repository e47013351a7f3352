"""Train a policy in a minute: record a few episodes of scripts, fit a small model to them, print losses and checkpoint.

    python examples/04_train_in_a_minute.py [--data FOLDER] [--out FOLDER]

With --data, that folder's episodes are learned from. Preset `debug` shows in seconds that all works; `fast` learns.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from mart.policies import TrainingProgress, TrainingSpec, train_policy

TASK = "two_arm_multi_cube_lifting"
MART = Path(sys.executable).with_name("mart")


def main() -> None:
    parser = argparse.ArgumentParser(description="Train a policy in a minute.")
    parser.add_argument("--data", type=Path, help="A folder of episodes; default: some are recorded.")
    parser.add_argument(
        "--out", type=Path, help="The run's folder; default: a new one in the temporary folder."
    )
    parser.add_argument("--preset", default="debug", help="debug, fast or paper.")
    given = parser.parse_args()
    out = given.out or Path(tempfile.mkdtemp(prefix="mart-run-"))
    spec = TrainingSpec(model="d-HBC", data=(given.data or record(out / "episodes"),), preset=given.preset)
    (checkpoint,) = train_policy(spec, out, show)
    print("The checkpoint is", checkpoint)


def record(folder: Path) -> Path:
    """Record four episodes of scripts, as fast as this computer steps them."""
    collect = [MART, "collect", "--lockstep", "--task", TASK, "--episodes", "4", "--out", folder]
    subprocess.run(list(map(str, collect)), check=True)
    return folder


def show(progress: TrainingProgress) -> None:
    losses = ", ".join(f"{name} {value:.3f}" for name, value in progress.losses.items())
    print(f"{progress.updates} of {progress.updates_in_all} updates: {losses}")


if __name__ == "__main__":
    main()
