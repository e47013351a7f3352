"""Commands that end with the process that started them."""

from __future__ import annotations

import os
import select
import subprocess
import sys
from pathlib import Path

from mart.runtime.child_process import start_child, stop_child

_STARTS_A_CHILD = """
import sys, time
from mart.runtime.child_process import start_child
command = (sys.executable, "-c", "import time; print('up', flush=True); time.sleep(600)")
child = start_child(command, sys.stderr.buffer, {}, piped=True)
child.stdout.readline()
print(child.pid, flush=True)
time.sleep(600)
"""
_STUBBORN = """
import signal, time
signal.signal(signal.SIGTERM, signal.SIG_IGN)
print("up", flush=True)
time.sleep(600)
"""


def test_it_gets_its_environment_and_says_into_the_log(tmp_path: Path) -> None:
    with (tmp_path / "log").open("wb") as log:
        child = start_child(
            (sys.executable, "-c", "import os; print(os.environ['WORD'])"), log, {"WORD": "yes"}
        )
        assert child.wait(30) == 0
    assert (tmp_path / "log").read_text() == "yes\n"


def test_it_dies_with_whoever_started_it() -> None:
    command = (sys.executable, "-c", _STARTS_A_CHILD)
    with subprocess.Popen(command, stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        died = os.pidfd_open(int(parent.stdout.readline()))
        try:
            parent.kill()
            assert select.select([died], [], [], 30.0)[0]
        finally:
            os.close(died)


def test_one_that_does_not_end_is_killed(tmp_path: Path) -> None:
    with (tmp_path / "log").open("wb") as log:
        child = start_child((sys.executable, "-c", _STUBBORN), log, {}, piped=True)
    assert child.stdin is not None
    assert child.stdout is not None
    with child.stdin, child.stdout:
        assert child.stdout.readline() == b"up\n"
        stop_child(child, timeout_s=0.2)
    assert child.returncode == -9
