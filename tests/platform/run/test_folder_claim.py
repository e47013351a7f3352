"""One platform at a time has a data folder, and what a killed one has left is ended."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mart.platform.run.folder_claim import ClaimHolder, claim_holder, claimed, leftovers_of
from mart.platform.run.platform_processes import MARK, end_processes, listener_of, processes_of
from mart.platform.run.stop import stop_platforms
from mart.protocol.errors import Conflict, NotFound, Unavailable
from mart.runtime.child_process import start_child

_SLEEPS = "import time; print('up', flush=True); time.sleep(600)"
_HOLDS = """
import sys, time
from pathlib import Path
from mart.platform.run.folder_claim import ClaimHolder, claimed
import os
with claimed(Path(sys.argv[1]) / "run", ClaimHolder(os.getpid(), sys.argv[1], sys.argv[2], "https://localhost:1/")):
    print("up", flush=True)
    time.sleep(600)
"""


def holder(folder: Path, mark: str = "a") -> ClaimHolder:
    return ClaimHolder(os.getpid(), str(folder), mark, "https://localhost:8443/")


def running(tmp_path: Path, code: str, *words: str, mark: str) -> subprocess.Popen[bytes]:
    """A process that says when it is up."""
    command = (sys.executable, "-c", code, *words)
    with (tmp_path / "log").open("wb") as log:
        process = start_child(command, log, {MARK: mark}, piped=True)
    assert process.stdout is not None
    assert process.stdin is not None
    process.stdin.close()
    assert process.stdout.readline() == b"up\n"
    process.stdout.close()
    return process


def test_a_second_platform_is_refused_and_told_of_the_first(tmp_path: Path) -> None:
    run_dir = tmp_path / "run"
    with claimed(run_dir, holder(tmp_path)):
        assert claim_holder(run_dir) == holder(tmp_path)
        with pytest.raises(Conflict) as refused, claimed(run_dir, holder(tmp_path, "b")):
            pass
        for word in (str(os.getpid()), "https://localhost:8443/", f"MART_DATA_DIR={tmp_path} mart stop"):
            assert word in str(refused.value)
        with claimed(run_dir / "collect", holder(tmp_path, "b")):
            pass
    assert claim_holder(run_dir) is None
    with claimed(run_dir, holder(tmp_path, "b")):
        pass


def test_what_a_killed_platform_left_is_ended_before_the_next_begins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mart.platform.run.folder_claim._LEFTOVER_PATIENCE_S", 0.0)
    run_dir = tmp_path / "run"
    killed = running(tmp_path, _HOLDS, str(tmp_path), "killed", mark="none")
    left = running(tmp_path, _SLEEPS, mark="killed")
    killed.kill()
    killed.wait()
    assert leftovers_of(run_dir) == ClaimHolder(killed.pid, str(tmp_path), "killed", "https://localhost:1/")
    with claimed(run_dir, holder(tmp_path)):
        assert left.wait() == -9


def test_a_claim_that_was_written_half_is_no_hindrance(tmp_path: Path) -> None:
    run_dir = tmp_path / "run"
    run_dir.mkdir()
    (run_dir / "claim.json").write_bytes(b'{"pid": 1')
    assert claim_holder(run_dir) is leftovers_of(run_dir) is None
    with claimed(run_dir, holder(tmp_path)):
        pass


def test_a_folder_that_cannot_be_written_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "run").touch()  # root may write anywhere, but a file is no folder
    with pytest.raises(Unavailable, match="cannot be written"), claimed(tmp_path / "run", holder(tmp_path)):
        pass


def test_marked_processes_are_found_and_ended(tmp_path: Path) -> None:
    process = running(tmp_path, _SLEEPS, mark="found")
    assert processes_of("found") == [process.pid]
    assert end_processes("found", patience_s=0.0) == [process.pid]
    assert processes_of("found") == []
    process.wait()


def test_who_listens_is_found(tmp_path: Path) -> None:
    code = (
        "import socket, sys; probe = socket.create_server(('127.0.0.1', 0)); "
        "print(probe.getsockname()[1], file=open(sys.argv[1], 'w'), flush=True); print('up', flush=True); "
        "import time; time.sleep(600)"
    )
    process = running(tmp_path, code, str(tmp_path / "port"), mark="listens")
    port = int((tmp_path / "port").read_text())
    assert listener_of(port) == process.pid
    process.kill()
    process.wait()
    assert listener_of(port) is None


def test_stop_ends_the_platform_and_a_collection_beside_it(tmp_path: Path) -> None:
    with pytest.raises(NotFound, match="No platform runs"):
        stop_platforms(tmp_path)
    platform = running(tmp_path, _HOLDS, str(tmp_path), "stopped", mark="stopped")
    assert [one.pid for one in stop_platforms(tmp_path, patience_s=5.0)] == [platform.pid]
    assert platform.wait() != 0
