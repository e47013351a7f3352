"""Programs that the documents show run as they stand, in a real room and on a real replica."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.contract.repository import ROOT
from tests.support.processes import environment_at, running_router, running_service
from tests.system.room_client import RoomClient

ROOM = "room-1"
_DEFAULT_ROUTER = "tcp/127.0.0.1:7447"


@pytest.fixture(scope="module")
def endpoint(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A router, a room, its scripts and a replica."""
    data_dir = tmp_path_factory.mktemp("data")
    with (
        running_router() as endpoint,
        running_service(
            ["sim", "--room", ROOM, "--seed", "1"],
            endpoint,
            data_dir,
            kind="sim",
            id=ROOM,
        ),
        running_service(["experts"], endpoint, data_dir, kind="experts", id="experts"),
        running_service(
            ["replica", "--name", "replica-1"], endpoint, data_dir, kind="replica", id="replica-1"
        ),
    ):
        yield endpoint


def program(document: str, name: str, folder: Path, endpoint: str) -> Path:
    """The file of this name that a document shows, with the test's router where it names one."""
    text = (ROOT / document).read_text()
    (shown,) = re.findall(rf"^```python file={re.escape(name)}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    path = folder / name
    path.write_text(shown.replace(_DEFAULT_ROUTER, endpoint))
    return path


def run(path: Path, endpoint: str) -> str:
    done = subprocess.run(
        [sys.executable, "-W", "error", path],
        env=environment_at(endpoint),
        capture_output=True,
        text=True,
        timeout=110,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def test_the_guides_operator_succeeds_beside_a_script(endpoint: str, tmp_path: Path) -> None:
    path = program("docs/how-to-write-an-operator.md", "lifter.py", tmp_path, endpoint)
    assert len([line for line in path.read_text().splitlines() if line]) <= 20
    assert run(path, endpoint) == "success\n"


def test_the_readmes_operator_drives_until_it_is_interrupted(endpoint: str, tmp_path: Path) -> None:
    path = program("README.md", "rise.py", tmp_path, endpoint)
    with (
        RoomClient(endpoint, ROOM) as client,
        subprocess.Popen(
            [sys.executable, "-W", "error", path],
            env=environment_at(endpoint),
        ) as process,
    ):
        try:
            client.states.wait_for(lambda state: state.arms[1].tool_in_base.z > 0.5)
        finally:
            process.send_signal(signal.SIGINT)
        assert process.wait(30) == 0


def test_the_references_worlds_are_stepped(endpoint: str, tmp_path: Path) -> None:
    path = program("docs/reference/rollouts.md", "rollouts.py", tmp_path, endpoint)
    assert run(path, endpoint) == "(64, 3) (64, 2)\n"
