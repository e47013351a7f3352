"""`mart run`: the whole platform comes up, says where it is, and leaves nothing behind."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from mart.platform.run.folder_claim import claim_holder
from mart.platform.run.platform_processes import processes_of
from mart.protocol import codec, keys
from mart.protocol.messages import RoomsRequest, RoomStatus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.support.message_collector import MessageCollector

_MART = str(Path(sys.executable).with_name("mart"))


def test_it_serves_until_its_terminal_is_closed_and_leaves_nothing_behind(tmp_path: Path) -> None:
    port = free_port()
    environment = _environment(tmp_path)
    with _running([_MART, "run", "--json", "--port", str(port)], environment) as process:
        assert process.stdout is not None
        told = json.loads(process.stdout.readline())
        assert told["url"] == f"https://localhost:{port}/"
        assert told["join_code"]
        doctor = subprocess.run(
            [_MART, "doctor", "--json"], env=environment, capture_output=True, check=False
        )
        assert json.loads(doctor.stdout)["ok"], doctor.stdout
        second = subprocess.run(
            [_MART, "run", "--port", str(port)], env=environment, capture_output=True, text=True, check=False
        )
        assert second.returncode != 0
        assert f"process {process.pid} at https://localhost:{port}/" in second.stderr
        assert len(_supervised(tmp_path)) == 10
        mark = _mark(tmp_path)
        process.send_signal(signal.SIGHUP)
        assert process.wait(60) == 0
    assert not processes_of(mark)


@pytest.mark.timeout(180)
def test_a_killed_one_leaves_nothing_in_the_way_of_the_next_and_a_killed_supervisor_is_told(
    tmp_path: Path,
) -> None:
    command = [_MART, "run", "--json", "--port", str(free_port())]
    environment = _environment(tmp_path)
    with _running(command, environment) as process:
        assert process.stdout is not None
        assert json.loads(process.stdout.readline())["url"]
        killed = _mark(tmp_path)
        process.kill()
    with _running(command, environment) as process:
        assert process.stdout is not None
        assert json.loads(process.stdout.readline())["url"]
        assert not processes_of(killed)
        mark = _mark(tmp_path)
        os.kill(int((tmp_path / "run" / "supervisord.pid").read_text()), signal.SIGKILL)
        assert process.stderr is not None
        assert "supervisor of the services" in process.stderr.read()
        assert process.wait(60) == 1
    assert not processes_of(mark)


def test_a_room_that_was_opened_comes_back_with_its_plan(tmp_path: Path) -> None:
    environment = _environment(tmp_path)
    wanted = RoomsRequest.Open(room="lab", task="two_arm_drink_tray_lifting", episodes=50)
    for request in (RoomsRequest(open=wanted), None):
        with _running([_MART, "run", "--json", "--port", str(free_port())], environment) as process:
            assert process.stdout is not None
            assert json.loads(process.stdout.readline())["room"] == "room-1"
            with (
                ZenohBus.connect(environment["MART_ROUTER"]) as bus,
                MessageCollector(bus, keys.status("lab").key, RoomStatus) as statuses,
            ):
                if request is not None:
                    bus.query(keys.rooms("platform-1"), codec.encode(request), timeout_s=45.0)
                status = statuses.wait_for(lambda status: status.task == wanted.task, timeout_s=45.0)
                assert (status.plan.episodes, status.plan.good) == (50, 0)
            process.terminate()
            assert process.wait(60) == 0


def _environment(data_dir: Path) -> dict[str, str]:
    router = f"tcp/127.0.0.1:{free_port()}"
    return {**os.environ, "MART_ROUTER": router, "MART_DATA_DIR": str(data_dir)}


@contextlib.contextmanager
def _running(command: list[str], environment: dict[str, str]) -> Iterator[subprocess.Popen[str]]:
    """Ends with the test, also where that fails. It hears a closed terminal though the tests themselves may not."""
    pipe = subprocess.PIPE
    heard = ["env", "--default-signal=HUP", *command]
    with subprocess.Popen(heard, env=environment, stdout=pipe, stderr=pipe, text=True) as process:
        try:
            yield process
        finally:
            process.terminate()


def _mark(data_dir: Path) -> str:
    holder = claim_holder(data_dir / "run")
    assert holder is not None
    return holder.mark


def _supervised(data_dir: Path) -> list[int]:
    supervisor = int((data_dir / "run" / "supervisord.pid").read_text())
    return [int(word) for word in Path(f"/proc/{supervisor}/task/{supervisor}/children").read_text().split()]
