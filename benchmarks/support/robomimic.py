"""robomimic in an environment and a process of its own: the peer of everything that trains."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from support.peers import program


@dataclass(frozen=True)
class Updates:
    """What some updates took, and what robomimic logged about them: means over them, by its own names."""

    version: str
    took_s: float
    losses: dict[str, float]
    parameters: int
    windows: int


class Robomimic:
    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def update(self, number: int) -> Updates:
        assert self._process.stdin is not None
        print(number, file=self._process.stdin, flush=True)
        for line in self._process.stdout or ():
            if line.startswith('{"version"'):  # robomimic prints notes of its own
                return Updates(**json.loads(line))
        raise SystemExit(
            f"robomimic ended with code {self._process.wait()}: run peers/robomimic/train.py by hand to see why."
        )


@contextmanager
def robomimic(file: Path, algorithm: str) -> Iterator[Robomimic]:
    """`algorithm`: bc or hbc, ready to learn from an HDF5 file."""
    process = subprocess.Popen(
        [*program("robomimic", "train.py"), file, algorithm],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        yield Robomimic(process)
    finally:
        process.communicate(timeout=60)
