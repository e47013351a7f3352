"""Keep the newest commands of a room, and give an episode those that came before its states did. Pure.

Commands may overtake the states that name them, the first state of an episode included.
"""

from __future__ import annotations

from collections import defaultdict, deque
from dataclasses import dataclass

from mart.episodes.mcap_entries import McapEntry
from mart.protocol.messages import Command, State
from mart.recorder.record.command_ledger import CommandNumber, number_of

PREROLL_NS = 10_000_000_000
_MAX_ARMS = 64
_MAX_KEPT = 4096  # an arm


@dataclass(frozen=True)
class KeptCommand:
    """Hold one command and how it is written."""

    command: Command
    entry: McapEntry

    @property
    def number(self) -> CommandNumber:
        """What tells it from all others for its arm."""
        return number_of(self.command)


class NewestCommands:
    """Keep the commands of the last 10 s, by arm."""

    def __init__(self) -> None:
        self._kept: defaultdict[str, deque[KeptCommand]] = defaultdict(lambda: deque(maxlen=_MAX_KEPT))

    def add(self, arm: str, kept_command: KeptCommand) -> None:
        """Keep a command for an arm, and forget those that are too old."""
        if arm not in self._kept and len(self._kept) >= _MAX_ARMS:
            return
        kept = self._kept[arm]
        kept.append(kept_command)
        while kept[0].entry.arrived_ns < kept_command.entry.arrived_ns - PREROLL_NS:
            kept.popleft()

    def clear(self) -> None:
        """Forget all: another run of the sim counts anew."""
        self._kept.clear()

    def of(self, arms: tuple[str, ...], since_ns: int) -> EarlyCommands:
        """Return what came for these arms since then (Unix time)."""
        found = {arm: [one for one in self._kept[arm] if one.entry.arrived_ns >= since_ns] for arm in arms}
        return EarlyCommands(found)


class EarlyCommands:
    """Hold back what came before an episode's first tick, until that tick tells what of it belongs to the episode."""

    def __init__(self, kept: dict[str, list[KeptCommand]]) -> None:
        self._kept = kept
        self._held: list[tuple[str, KeptCommand]] = []  # came between the first state and the first tick
        self._taken = False

    def hold(self, arm: str, kept: KeptCommand) -> bool:
        """Hold back a command that came after the first state, so that all are written in order; False: write it."""
        if self._taken or len(self._held) >= _MAX_KEPT:
            return False
        self._held.append((arm, kept))
        return True

    def take(self, state: State | None) -> list[tuple[str, KeptCommand]]:
        """Return, once, what belongs to the episode: from the newest before the first tick's command on.

        state: after the first tick; None where none came.
        """
        named = {arm.arm: (arm.seat_epoch, arm.sequence) for arm in state.arms if arm.fresh} if state else {}
        found = list(self._held)
        for arm, kept in self._kept.items():
            before = [one for one in kept if arm not in named or one.number < named[arm]]
            after = [one for one in kept if arm in named and one.number >= named[arm]]
            newest = max(before, key=lambda one: one.number, default=None)
            found += [(arm, one) for one in ([newest] if newest else []) + after]
        self._kept, self._held, self._taken = {}, [], True
        return sorted(found, key=lambda one: one[1].entry.arrived_ns)
