"""Peers live in virtual environments of their own, made when first needed; the project never depends on them."""

from __future__ import annotations

import subprocess
import sys
import venv
from pathlib import Path

_BENCHMARKS = Path(__file__).parent.parent


def program(peer: str, name: str) -> list[Path]:
    """The command that runs one of the peer's programs in the peer's environment.

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
