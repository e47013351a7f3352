"""Commands that end with the supervisor that the environment names."""

from __future__ import annotations

import subprocess
import sys

import pytest

from mart.runtime.supervision import SUPERVISOR_PID, end_with_supervisor

_WAITS = "import time; print('up', flush=True); time.sleep(600)"
_WATCHES = """
import signal, sys, time
from mart.runtime.supervision import end_with_supervisor
if sys.argv[1] == "stubborn":
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
if sys.argv[1] == "waits":  # as the router does
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})
end_with_supervisor(grace_s=0.2 if sys.argv[1] == "stubborn" else 60.0)
print("up", flush=True)
if sys.argv[1] == "waits":
    signal.sigwait({signal.SIGTERM})
    sys.exit(0)
time.sleep(600)
"""


@pytest.mark.parametrize(("kind", "status"), [("plain", -15), ("waits", 0), ("stubborn", -9)])
def test_it_ends_with_its_supervisor(kind: str, status: int, monkeypatch: pytest.MonkeyPatch) -> None:
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", _WAITS], stdout=pipe) as supervisor:
        monkeypatch.setenv(SUPERVISOR_PID, str(supervisor.pid))
        with subprocess.Popen([sys.executable, "-c", _WATCHES, kind], stdout=pipe) as supervised:
            for process in (supervisor, supervised):
                assert process.stdout is not None
                assert process.stdout.readline() == b"up\n"
            supervisor.kill()
            supervisor.wait()
            assert supervised.wait(30) == status


def test_one_whose_supervisor_is_gone_does_not_begin(monkeypatch: pytest.MonkeyPatch) -> None:
    with subprocess.Popen([sys.executable, "-c", ""]) as supervisor:
        supervisor.wait()
    monkeypatch.setenv(SUPERVISOR_PID, str(supervisor.pid))
    with pytest.raises(SystemExit):
        end_with_supervisor()


def test_a_command_by_hand_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(SUPERVISOR_PID, raising=False)
    end_with_supervisor()
