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
from typing import Any

import pytest

from mart.platform.run.folder_claim import claim_holder
from mart.platform.run.platform_processes import processes_of
from mart.protocol import codec, keys
from mart.protocol.messages import RoomsRequest, RoomStatus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.support.message_collector import MessageCollector

_MART = str(Path(sys.executable).with_name("mart"))
_LAB_TASK = "two_arm_drink_tray_lifting"


@pytest.mark.timeout(240)
def test_it_serves_until_its_terminal_is_closed_or_it_is_killed_and_leaves_nothing_in_the_way_of_the_next(
    tmp_path: Path,
) -> None:
    """Three in the same folder: the first is ended, the second killed, the third loses its supervisor."""
    port = free_port()
    command = [_MART, "run", "--json", "--port", str(port)]
    environment = _environment(tmp_path)
    with _running(command, environment) as process:
        told = _told(process)
        assert told["url"] == f"https://localhost:{port}/"
        assert told["join_code"]
        assert len(_supervised(tmp_path)) == 10
        a_second_one_is_refused(process, port, environment)
        with _lab_statuses(environment) as (bus, statuses):
            wanted = RoomsRequest.Open(room="lab", task=_LAB_TASK, episodes=50)
            bus.query(keys.rooms("platform-1"), codec.encode(RoomsRequest(open=wanted)), timeout_s=45.0)
            a_room_has_its_plan(statuses)
        doctor = subprocess.run(
            [_MART, "doctor", "--json"], env=environment, capture_output=True, check=False
        )
        assert json.loads(doctor.stdout)["ok"], doctor.stdout
        ended = _mark(tmp_path)
        process.send_signal(signal.SIGHUP)
        assert process.wait(60) == 0
    assert not processes_of(ended)
    with _running(command, environment) as process:
        assert _told(process)["room"] == "room-1"
        with _lab_statuses(environment) as (_, statuses):
            a_room_has_its_plan(statuses)
        killed = _mark(tmp_path)
        process.kill()
    with _running(command, environment) as process:
        assert _told(process)["url"]
        assert not processes_of(killed)
        mark = _mark(tmp_path)
        os.kill(int((tmp_path / "run" / "supervisord.pid").read_text()), signal.SIGKILL)
        assert process.stderr is not None
        assert "supervisor of the services" in process.stderr.read()
        assert process.wait(60) == 1
    assert not processes_of(mark)


def a_second_one_is_refused(process: subprocess.Popen[str], port: int, environment: dict[str, str]) -> None:
    second = subprocess.run(
        [_MART, "run", "--port", str(port)], env=environment, capture_output=True, text=True, check=False
    )
    assert second.returncode != 0
    assert f"process {process.pid} at https://localhost:{port}/" in second.stderr


def a_room_has_its_plan(statuses: MessageCollector[RoomStatus]) -> None:
    status = statuses.wait_for(lambda status: status.task == _LAB_TASK, timeout_s=45.0)
    assert (status.plan.episodes, status.plan.good) == (50, 0)


@contextlib.contextmanager
def _lab_statuses(
    environment: dict[str, str],
) -> Iterator[tuple[ZenohBus, MessageCollector[RoomStatus]]]:
    with (
        ZenohBus.connect(environment["MART_ROUTER"]) as bus,
        MessageCollector(bus, keys.status("lab").key, RoomStatus) as statuses,
    ):
        yield bus, statuses


def _told(process: subprocess.Popen[str]) -> dict[str, Any]:
    """What it prints when it is up."""
    assert process.stdout is not None
    told: dict[str, Any] = json.loads(process.stdout.readline())
    return told


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
