"""How the trainer's threads wait for each other."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest


@pytest.mark.system
@pytest.mark.parametrize(("given", "taken"), [({}, "PASSIVE"), ({"OMP_WAIT_POLICY": "ACTIVE"}, "ACTIVE")])
def test_they_sleep_unless_somebody_wants_them_to_spin(given: dict[str, str], taken: str) -> None:
    clean = {name: value for name, value in os.environ.items() if name != "OMP_WAIT_POLICY"}
    command = [sys.executable, "-c", "import mart.trainer.train.training"]
    told = subprocess.run(
        command, env={**clean, **given, "OMP_DISPLAY_ENV": "TRUE"}, capture_output=True, text=True, check=True
    ).stderr
    assert f"OMP_WAIT_POLICY = '{taken}'" in told
