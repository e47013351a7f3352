"""robosuite's TwoArmLift: the peer of everything that steps two arms."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from support.peers import Peer, running


@dataclass(frozen=True)
class Steps:
    """Milliseconds of processor time: of every control step, and of the bare 25 x mj_step beside."""

    version: str
    step_ms: list[float]
    bare_ms: list[float]


class Robosuite:
    """One process. `begin` lets it step, `end` waits for its times; several may step at once."""

    def __init__(self, peer: Peer) -> None:
        self._peer = peer

    def steps(self, number: int) -> Steps:
        self.begin(number)
        return self.end()

    def begin(self, number: int) -> None:
        self._peer.tell(str(number))

    def end(self) -> Steps:
        return Steps(**self._peer.answer())


@contextmanager
def robosuite() -> Iterator[Robosuite]:
    """Ready to step."""
    with running("robosuite", "control.py") as peer:
        yield Robosuite(peer)
