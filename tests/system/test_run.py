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

from mart.protocol import codec, keys
from mart.protocol.messages import RoomsRequest, RoomStatus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.support.message_collector import MessageCollector

_MART = str(Path(sys.executable).with_name("mart"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_serves_until_it_is_asked_to_stop_and_leaves_nothing_behind(
    tmp_path: Path, number: signal.Signals
) -> None:
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
        assert "is MART running already?" in second.stderr
        children = _supervised(tmp_path)
        assert len(children) == 10
        process.send_signal(number)
        assert process.wait(60) == 0
    assert not [pid for pid in children if Path(f"/proc/{pid}").exists()]


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
    """Ends with the test, also where that fails."""
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        try:
            yield process
        finally:
            process.terminate()


def _supervised(data_dir: Path) -> list[int]:
    supervisor = int((data_dir / "run" / "supervisord.pid").read_text())
    return [int(word) for word in Path(f"/proc/{supervisor}/task/{supervisor}/children").read_text().split()]
