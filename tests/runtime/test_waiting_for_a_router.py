"""A service that waits for its router says so, and ends when it is asked to."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from mart.runtime.ports import free_port

pytestmark = pytest.mark.system

PROGRAM = """
from mart.protocol.vocabulary import ServiceKind
from mart.runtime import cli, service
from mart.runtime.settings import Settings
import click

@click.command()
def wait() -> None:
    {body}

cli.cli.get_command = lambda ctx, name: wait
cli.main()
"""
THREADED = "service.connected(Settings(), ServiceKind.DRIVER, 'room-1-arm0').__enter__()"
ON_A_LOOP = "service.run_async(Settings(), ServiceKind.WEB, 'web', None)"


@pytest.mark.parametrize("body", [THREADED, ON_A_LOOP], ids=["threaded", "on a loop"])
def test_it_says_what_it_waits_for_and_ends(tmp_path: Path, body: str) -> None:
    environment = {"MART_ROUTER": f"tcp/127.0.0.1:{free_port()}", "MART_DATA_DIR": str(tmp_path)}
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM.format(body=body), "wait"],
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    ) as service:
        assert service.stderr is not None
        try:
            assert "No router answers" in service.stderr.readline()
            service.send_signal(signal.SIGTERM)
            service.wait(20)
        finally:
            service.kill()
