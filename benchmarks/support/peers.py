"""Peers live in virtual environments and processes of their own, made when first needed; the project never depends on
them. They are told lines and answer with lines of JSON.
"""

from __future__ import annotations

import json
import subprocess
import sys
import venv
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

_BENCHMARKS = Path(__file__).parent.parent


class Peer:
    def __init__(self, process: subprocess.Popen[str], program: str) -> None:
        self._process, self._program = process, program

    def tell(self, line: str) -> None:
        assert self._process.stdin is not None
        print(line, file=self._process.stdin, flush=True)

    def answer(self) -> dict[str, Any]:
        """The next line of JSON: peers print notes of their own between."""
        for line in self._process.stdout or ():
            if line.startswith("{"):
                answer: dict[str, Any] = json.loads(line)
                return answer
        raise SystemExit(
            f"{self._program} ended with code {self._process.wait()}: run it by hand to see why."
        )


@contextmanager
def running(peer: str, name: str, *arguments: str | Path) -> Iterator[Peer]:
    """One of the peer's programs. It ends when it is told no more."""
    process = subprocess.Popen(
        [*_program(peer, name), *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        yield Peer(process, f"peers/{peer}/{name}")
    finally:
        process.communicate(timeout=60)


def _program(peer: str, name: str) -> list[Path]:
    """The command that runs it in the peer's environment.

    A peer is a folder of benchmarks/peers: programs, requirements.txt and, where something has to be installed without
    its dependencies, requirements-alone.txt.
    """
    folder = _BENCHMARKS / "peers" / peer
    environment = _BENCHMARKS.parent / ".venv-peers" / peer
    python, ready = environment / "bin" / "python", environment / "ready"
    if not ready.is_file():
        print(f"making {environment} …", file=sys.stderr)
        venv.create(environment, with_pip=True)
        install: list[str | Path] = [python, "-m", "pip", "install", "-q", "--disable-pip-version-check"]
        subprocess.run([*install, "-r", folder / "requirements.txt"], check=True)
        alone = folder / "requirements-alone.txt"
        if alone.is_file():
            subprocess.run([*install, "--no-deps", "-r", alone], check=True)
        ready.touch()
    return [python, folder / name]
