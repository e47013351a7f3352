"""`mart reproduce`, whole and small: killed while it collects and while it trains, it goes on to the same end."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from mart.protocol import clock
from mart.runtime.child_process import MART, STANDARD_ERROR, start_child
from mart.runtime.step_record import StepRecord, read_records

_TASK = "two_arm_multi_cube_lifting"
_COLLECTED = f"data/experienced/{_TASK}/batch-01"
_RUN = f"runs/table2/{_TASK}/BC-RNN"
_COMMAND = (
    *("reproduce", "table2", "--preset", "debug", "--episodes", "2", "--tasks", _TASK),
    *("--models", "BC-RNN", "--seeds", "1", "--set", "updates=40", "--json", "--out"),
)
_PATIENCE_S = 240.0


def _killed_when(folder: Path, happened: Callable[[dict[str, StepRecord]], bool]) -> None:
    process = start_child((MART, *_COMMAND, folder), STANDARD_ERROR, {})
    deadline_s = clock.monotonic_s() + _PATIENCE_S
    try:
        while not happened(read_records(folder)):
            assert process.poll() is None
            assert clock.monotonic_s() < deadline_s
            with pytest.raises(subprocess.TimeoutExpired):
                process.wait(0.1)
    finally:
        process.kill()
        process.wait()


@pytest.mark.timeout(600)
def test_killed_twice_it_goes_on_to_a_whole_table(tmp_path: Path) -> None:
    folder = tmp_path / "reproduced"
    _killed_when(
        folder,
        lambda records: _COLLECTED in records and any((folder / _COLLECTED).rglob("*.mcap*")),
    )
    _killed_when(folder, lambda records: _RUN in records and records[_RUN].status == "running")
    collected = read_records(folder)[_COLLECTED]
    assert collected.status == "done"
    assert len(collected.attempts) == 2
    assert list((folder / "set-aside" / _COLLECTED).parent.glob("batch-01-*"))

    told = json.loads(_run(folder).splitlines()[-1])
    assert told["complete"]
    assert set(told["steps"].values()) == {"done"}
    records = read_records(folder)
    assert records[_COLLECTED] == collected
    assert len(records[_RUN].attempts) == 2
    report = folder / "report"
    assert "Multi-Cube Lifting" in (report / "index.html").read_text()
    assert (report / "report.pdf").read_bytes().startswith(b"%PDF")
    assert f"mart train --model BC-RNN --data data/experienced/{_TASK}" in (report / "steps.csv").read_text()

    _run(folder)
    assert read_records(folder) == records, "what is done was not done again"


def _run(folder: Path) -> str:
    done = subprocess.run([MART, *_COMMAND, folder], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout
