"""Know which commands an episode's states name, and which of those are not there. Pure.

A state names the command that moved each arm by the arm's epoch and the command's number. Both only grow, and commands
and states come in any order: each on a way of its own, with losses.
"""

from __future__ import annotations

from collections import OrderedDict, defaultdict
from dataclasses import dataclass, field

from mart.protocol.messages import Command, State

_MAX_UNNAMED = 4096  # an arm: commands that no state has named yet; a state names one of the newest

CommandNumber = tuple[int, int]  # the seat's epoch, the command's number


def number_of(command: Command) -> CommandNumber:
    """Return what tells a command from all others for its arm; a later one's is greater."""
    return command.seat_epoch, command.sequence


@dataclass
class _ArmCommands:
    """Hold what is known of one arm's commands."""

    named: CommandNumber = (0, 0)  # the newest
    unnamed: OrderedDict[CommandNumber, None] = field(
        default_factory=OrderedDict
    )  # there, newer than `named`
    awaited: set[CommandNumber] = field(default_factory=set)  # named and not there

    def name(self, number: CommandNumber) -> None:
        if number not in self.unnamed and number > self.named:
            self.awaited.add(number)
        self.named = max(self.named, number)
        self.unnamed = OrderedDict((kept, None) for kept in self.unnamed if kept > self.named)

    def add(self, number: CommandNumber) -> bool:
        if number in self.awaited:
            self.awaited.remove(number)
            return True
        if number > self.named:
            self.unnamed[number] = None
            while len(self.unnamed) > _MAX_UNNAMED:
                self.unnamed.popitem(last=False)
        return False


class CommandLedger:
    """Keep the account of one episode: commands that are there against those that states name."""

    def __init__(self) -> None:
        self._arms: defaultdict[str, _ArmCommands] = defaultdict(_ArmCommands)

    @property
    def missing(self) -> int:
        """How many commands states name that are not there."""
        return sum(len(arm.awaited) for arm in self._arms.values())

    def awaits(self, arm: str, command: Command) -> bool:
        """Tell whether a state has named this command and it is not there yet."""
        return arm in self._arms and number_of(command) in self._arms[arm].awaited

    def add_state(self, state: State) -> None:
        """Take the names that a state says. States come in their order; what was lost between them is not known."""
        for arm in state.arms:
            if arm.fresh and arm.sequence:  # an imported action came of no command
                self._arms[arm.arm].name((arm.seat_epoch, arm.sequence))

    def add_command(self, arm: str, command: Command) -> bool:
        """Take a command that is there; tell whether a state had named it already."""
        return self._arms[arm].add(number_of(command))
