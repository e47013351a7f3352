"""Examples 04 and 05 as somebody runs them: a policy is trained, and then evaluated on a replica of its own."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from mart.sim.world import World
from tests.trainer import recorded

EXAMPLES = Path(__file__).parents[2] / "examples"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.timeout(300),  # importing torch takes its time on a busy machine
]


def run(example: str, *arguments: object, data_dir: Path) -> str:
    """What the example printed."""
    command = [sys.executable, str(EXAMPLES / example), *map(str, arguments)]
    environment = os.environ | {"MART_DATA_DIR": str(data_dir), "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def checkpoint(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder, world = tmp_path_factory.mktemp("example"), World.build(recorded.TASK)
    for seed in (1, 2):
        recorded.write(folder / "episodes", world, recorded.perform(world, seed, number=seed))
    out = folder / "run"
    printed = run("04_train_in_a_minute.py", "--data", folder / "episodes", "--out", out, data_dir=folder)
    assert "20 of 20 updates: loss/planner" in printed
    found = re.search(r"The checkpoint is (.*)", printed)
    assert found is not None
    return Path(found[1])


def test_a_checkpoint_is_trained(checkpoint: Path) -> None:
    assert sorted(path.name for path in checkpoint.iterdir()) == ["checkpoint.json", "weights.safetensors"]


def test_it_is_evaluated(checkpoint: Path, tmp_path: Path) -> None:
    words = (checkpoint, "--episodes", 2, "--time-limit", 0.5)
    printed = run("05_evaluate_a_policy.py", *words, data_dir=tmp_path)
    assert printed.splitlines()[-1] == "Success rate: 0 of 2 (0 %)"
