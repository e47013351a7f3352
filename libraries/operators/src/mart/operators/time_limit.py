"""Bound how long an operator may think: people do not wait for a program that hangs."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Mapping

from mart.operators.operator import Operator, SeatView, ToolTarget
from mart.protocol.errors import Unavailable
from mart.protocol.messages import Cue


class TimeLimitedOperator(Operator):
    """Run another operator on a thread of its own; what it does not answer in time raises Unavailable.

    The thread ends with the process: nothing can stop code that hangs.
    """

    def __init__(self, operator: Operator, limit_s: float) -> None:
        self._operator, self._limit_s = operator, limit_s
        self._work: queue.SimpleQueue[tuple[Callable[[], object], queue.SimpleQueue[object]]] = (
            queue.SimpleQueue()
        )
        threading.Thread(target=self._run, name="operator", daemon=True).start()

    def prepare(self) -> None:
        """Hand on, and wait as long as it takes; see `Operator.prepare`."""
        self._ask(self._operator.prepare, None)

    def begin(self, episode: int) -> None:
        """Hand on; see `Operator.begin`."""
        self._ask(lambda: self._operator.begin(episode), self._limit_s)

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        """Hand on; see `Operator.act`."""
        return self._ask(lambda: self._operator.act(view), self._limit_s)  # type: ignore[return-value]  # checked by its caller

    def on_cue(self, cue: Cue, arm: str) -> None:
        """Hand on; see `Operator.on_cue`."""
        self._ask(lambda: self._operator.on_cue(cue, arm), self._limit_s)

    def _ask(self, deed: Callable[[], object], limit_s: float | None) -> object:
        answer: queue.SimpleQueue[object] = queue.SimpleQueue()
        self._work.put((deed, answer))
        try:
            said = answer.get(timeout=limit_s)
        except queue.Empty:
            raise Unavailable(
                f"The operator took longer than {limit_s:g} s for one tick; be quicker, or raise the limit."
            ) from None
        if isinstance(said, Exception):
            raise said
        return said

    def _run(self) -> None:
        while True:
            deed, answer = self._work.get()
            try:
                answer.put(deed())
            except Exception as error:  # noqa: BLE001 - anybody's code; its failure is raised where it was asked
                answer.put(error)
