"""robosuite in an environment and a process of its own: the peer of everything that steps two arms."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from support.peers import program


@dataclass(frozen=True)
class Steps:
    """Milliseconds of processor time: of every control step, and of the bare 25 x mj_step beside."""

    version: str
    step_ms: list[float]
    bare_ms: list[float]


class Robosuite:
    """One process. `begin` lets it step, `end` waits for its times; several may step at once."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def steps(self, number: int) -> Steps:
        self.begin(number)
        return self.end()

    def begin(self, number: int) -> None:
        assert self._process.stdin is not None
        print(number, file=self._process.stdin, flush=True)

    def end(self) -> Steps:
        for line in self._process.stdout or ():
            if line.startswith("{"):  # robosuite prints notes of its own
                return Steps(**json.loads(line))
        raise SystemExit(
            f"robosuite ended with code {self._process.wait()}: run peers/robosuite/control.py by hand to see why."
        )


@contextmanager
def robosuite() -> Iterator[Robosuite]:
    """TwoArmLift, ready to step."""
    process = subprocess.Popen(
        program("robosuite", "control.py"),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        yield Robosuite(process)
    finally:
        process.communicate(timeout=30)
