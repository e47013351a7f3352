"""What the supervisor is told, and what it tells: against a real supervisord where that matters."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from mart.platform.run.plan import PlatformOptions, Process
from mart.platform.run.supervisor import Supervisor
from mart.protocol import clock, keys
from mart.protocol.errors import Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.alive_wait import await_alive
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.child_process import start_child, stop_child
from mart.runtime.ports import free_port


def test_a_supervisor_that_does_not_answer_is_waited_for_only_so_long(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def hang(*_: object, timeout: float, **__: object) -> None:
        raise subprocess.TimeoutExpired("supervisorctl", timeout)

    monkeypatch.setattr("mart.platform.run.supervisor.subprocess.run", hang)
    supervisor = Supervisor(PlatformOptions(tmp_path), (), tmp_path / "socket")
    with pytest.raises(Unavailable, match="did not answer"):
        supervisor.add(Process(("sim", "--room", "lab"), ServiceKind.SIM, "lab"))
    assert supervisor.processes == ()
    assert supervisor.refusals() == {}


@pytest.mark.system
def test_a_process_that_ends_with_a_sentence_is_told(tmp_path: Path) -> None:
    plan = (Process(("sim", "--task", "juggling"), ServiceKind.SIM, "lab"),)
    supervisor = Supervisor(PlatformOptions(tmp_path), plan, tmp_path / "socket")
    with supervisord(supervisor, tmp_path):
        deadline_s = clock.monotonic_s() + 60.0
        while not (told := supervisor.refusals()):
            assert clock.monotonic_s() < deadline_s
            clock.sleep_s(0.1)
        assert "juggling" in told["sim-lab"]


@pytest.mark.system
def test_all_are_stopped_and_who_is_needed_by_others_later(tmp_path: Path) -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    plan = (
        Process(("router", "--listen", endpoint), ServiceKind.ROUTER, "router"),
        Process(("recorder", "--name", "recorder-1"), ServiceKind.RECORDER, "recorder-1"),
        Process(("sim", "--task", "juggling"), ServiceKind.SIM, "lab"),  # it never starts
        Process(("experts",), ServiceKind.EXPERTS, "experts"),
    )
    supervisor = Supervisor(PlatformOptions(tmp_path), plan, tmp_path / "socket")
    environment = {"MART_ROUTER": endpoint, "MART_DATA_DIR": str(tmp_path / "data")}
    with supervisord(supervisor, tmp_path, environment), ZenohBus.connect(endpoint) as bus:
        awaited = {keys.alive(one.kind, one.id) for one in plan if one.kind != ServiceKind.SIM}
        assert await_alive(bus, keys.EVERY_ALIVE, awaited, 60.0) >= awaited
        gone: list[str] = []

        def on_token(key: str, alive: bool) -> None:
            if not alive:
                gone.append(key)

        with contextlib.closing(bus.watch(keys.EVERY_ALIVE, on_token)):
            supervisor.stop()
            supervisor.stop()  # again, for nothing
        assert [key.split("/")[2] for key in gone][:2] == ["experts", "recorder"]


@contextlib.contextmanager
def supervisord(
    supervisor: Supervisor, folder: Path, environment: dict[str, str] | None = None
) -> Iterator[None]:
    words = ["--nodaemon", "--silent", "--configuration", str(supervisor.config)]
    with (folder / "log").open("wb") as log:
        process = start_child(
            [sys.executable, "-m", "mart.platform.run.supervisord", *words],
            log,
            environment or {},
            death_signal=signal.SIGTERM,
        )
    try:
        yield
    finally:
        stop_child(process, 30.0)


def test_what_an_earlier_platform_ended_with_is_no_refusal(tmp_path: Path) -> None:
    plan = (Process(("sim", "--room", "lab"), ServiceKind.SIM, "lab"),)
    log = tmp_path / "logs" / "sim-lab.log"
    log.parent.mkdir()
    log.write_text("mart: Stopped.\n")
    supervisor = Supervisor(PlatformOptions(tmp_path), plan, tmp_path / "socket")
    assert supervisor._last_refusal("sim-lab") == ""
    with log.open("a") as file:
        file.write("mart: The disk is full.\nand more\n")
    assert supervisor._last_refusal("sim-lab") == "The disk is full."
    log.write_text("mart: Anew.\n")
    assert supervisor._last_refusal("sim-lab") == "Anew."
