"""Tell whether an operator's clutch was pressed since the last stop: what was held through it moves nothing. Pure."""

from __future__ import annotations

from dataclasses import dataclass

_MACHINE_RESTS_S = 0.5  # after people let go of a stop; its driver must see that the clutch was let go


@dataclass
class Clutch:
    """Follow the clutch of one arm's operator. A machine has none: people pressed it when they let a stop go."""

    _let_go: bool = False
    _pressed: bool = False
    _runs_since_s: float | None = None

    def stopped(self) -> None:
        """Take note that the room is stopped."""
        self._let_go = self._pressed = False
        self._runs_since_s = None

    def engages(self, engaged: bool, *, machine: bool, now_s: float) -> bool:
        """Return whether the arm may follow; engaged: what the operator's newest command says."""
        if self._runs_since_s is None:
            self._runs_since_s = now_s
        if not engaged:
            self._let_go = True
            return False
        if machine and now_s - self._runs_since_s >= _MACHINE_RESTS_S:
            self._let_go = True
        self._pressed = self._pressed or self._let_go
        return self._pressed
