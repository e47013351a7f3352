"""The platform as containers, in a compose project of its own beside whatever else the engine runs."""

from __future__ import annotations

import json
import os
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.contract.repository import ROOT

_COMPOSE = (
    ("docker", "compose")
    if subprocess.run(["docker", "compose", "version"], capture_output=True, check=False).returncode == 0
    else ("docker-compose",)
)


@dataclass(frozen=True)
class Stack:
    """`folder` gets copies of what a web_client has to know: the join code and the site's certificate."""

    project: str
    port: int
    folder: Path

    def up(self) -> str:
        """`make up`; returns what it printed and fills `folder`."""
        printed = self._run(["make", "up"])
        for name in ("join-code", "certificates/site.crt"):
            copy = self.folder / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_text(self.inside("web", "cat", f"/data/{name}"))
        self.bus_secret.write_text(self.inside("router", "cat", "/bus/secret"))
        self.bus_secret.chmod(0o600)
        return printed

    @property
    def bus_secret(self) -> Path:
        """A copy of what lets this process speak to the router."""
        return self.folder / "bus-secret"

    def down(self) -> None:
        self._run(["make", "down"])

    def forget(self) -> None:
        """Stops all and removes the volumes."""
        self._run([*_COMPOSE, "down", "--volumes"])

    def inside(self, service: str, *command: str) -> str:
        """Runs a command in a service's container; returns what it printed."""
        return self._run([*_COMPOSE, "exec", "-T", service, *command])

    def kill(self, service: str) -> None:
        """SIGKILL from inside, as a crash: the engine takes its own `kill` for a wish and would not restart."""
        killer = ["docker", "exec", self.container(service), "sh", "-c", "kill -9 -1"]
        subprocess.run(killer, capture_output=True, check=False)  # its container ends under it

    def logs(self) -> str:
        return self._run([*_COMPOSE, "logs", "--no-color"])

    def services(self) -> list[str]:
        return self._run([*_COMPOSE, "config", "--services"]).split()

    def container(self, service: str) -> str:
        return self._run([*_COMPOSE, "ps", "-q", service]).strip()

    def address(self, service: str) -> str:
        """On the containers' bridge, which this machine reaches and others do not."""
        networks = json.loads(
            self._run(
                [
                    "docker",
                    "inspect",
                    "--format",
                    "{{json .NetworkSettings.Networks}}",
                    self.container(service),
                ]
            )
        )
        return str(next(iter(networks.values()))["IPAddress"])

    def _run(self, command: Sequence[str]) -> str:
        settings = {"COMPOSE_PROJECT_NAME": self.project, "MART_PORT": str(self.port)}
        done = subprocess.run(
            command, cwd=ROOT, env={**os.environ, **settings}, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"`{' '.join(command)}` failed:\n{done.stdout}{done.stderr}"
        return done.stdout


def join_code_in(printed: str) -> str:
    """The join code that `make up` prints."""
    found = re.search(r"Join code\s+(\S+)", printed)
    assert found is not None, printed
    return found[1]
