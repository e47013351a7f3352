"""robomimic's own code opens an export of ours with pictures, and trains on it.

In an environment of its own, which `make test-robomimic` makes. ROBOMIMIC_SOURCE names another copy of its source.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest

from mart.sim.world import World
from tests.contract.repository import ROOT
from tests.recorder.export.test_pictures import write
from tests.trainer import recorded

_ENVIRONMENT = ROOT / os.environ.get("ROBOMIMIC_ENVIRONMENT", ".venv-robomimic")
_SCRIPT = Path(__file__).with_name("read_export.py")
_TICKS = 24
_TIMEOUT_S = 240.0


@pytest.fixture(scope="module")
def export_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two demonstrations with pictures and depth."""
    root, world = tmp_path_factory.mktemp("robomimic"), World.build(recorded.TASK)
    for seed in (1, 2):
        states = recorded.perform(world, seed, number=seed, most_ticks=_TICKS)
        recorded.write(root / "episodes", world, states, with_model=True)
    write(root / "episodes", root / "lifting.hdf5", "robomimic", "--camera", "arm0:48x48", "--depth")
    return root / "lifting.hdf5"


def test_its_loader_reads_every_kind_of_number_and_a_tiny_bc_trains_two_epochs(
    export_path: Path, tmp_path: Path
) -> None:
    done = subprocess.run(
        [_ENVIRONMENT / "bin" / "python", _SCRIPT, export_path, tmp_path],
        env={**os.environ, "OMP_NUM_THREADS": "1", "HF_HUB_OFFLINE": "1"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=_TIMEOUT_S,
        check=False,
    )
    assert done.returncode == 0, done.stdout
    said = json.loads(done.stdout.splitlines()[-1])
    print(f"robomimic {said['version']}")
    assert (said["rows"], said["environment"]) == (2 * _TICKS, recorded.TASK)
    assert {"model_epoch_1.pth", "model_epoch_2.pth"} <= {*said["checkpoints"]}
