"""Check a finished file by itself: every checksum, every tick, and every command that its states name."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.errors import MartError
from mart.protocol.messages import Command, State
from mart.protocol.recording import STATE
from mart.recorder.record.command_ledger import CommandLedger

_COMMAND_TOPIC = re.compile(r"/arm/([^/]+)/command")


@dataclass(frozen=True)
class FileCheck:
    """Tell what a file lacks. error: why it cannot be read, None where it can."""

    path: Path
    missing_ticks: int = 0
    missing_commands: int = 0
    error: str | None = None

    @property
    def is_whole(self) -> bool:
        """Whether it can be read and nothing is missing."""
        return self.error is None and not self.missing_ticks and not self.missing_commands


def check_file(path: Path) -> FileCheck:
    """Read all of a file and count what it lacks. Raises NotFound where there is none."""
    try:
        EpisodeFile.open(path).check()
        return _counted(path)
    except MartError as error:
        return FileCheck(path, error=str(error))


def _counted(path: Path) -> FileCheck:
    """Compare what the states name with what is there; the first state comes from no recorded tick."""
    ledger, missing_ticks, last_tick = CommandLedger(), 0, None
    for message in EpisodeFile(path, {}).messages():
        named = _COMMAND_TOPIC.fullmatch(message.topic)
        if named is not None:
            ledger.add_command(named[1], codec.decode(Command, message.payload))
        elif message.topic == STATE:
            state = codec.decode(State, message.payload)
            if last_tick is not None:
                ledger.add_state(state)
                missing_ticks += state.tick - last_tick - 1
            last_tick = state.tick
    return FileCheck(path, missing_ticks, ledger.missing)
