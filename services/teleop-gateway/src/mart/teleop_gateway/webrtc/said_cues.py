"""Remember what each arm's driver said to the partners, for as long as it is shown. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from mart.protocol.messages import Cue, Event, RoomStatus, cue_word

SHOWN_S = 4.0
_NAME_CHARACTERS = 24


@dataclass(frozen=True)
class SaidCue:
    """Name who said what. `number` is greater for what is said later; `name` is empty for a machine without one."""

    arm: str
    name: str
    cue: str
    number: int


class SaidCues:
    """Hold the newest word of each arm. `now_s` is of a clock that never goes back."""

    def __init__(self) -> None:
        self._said: dict[str, tuple[SaidCue, float]] = {}

    def take(self, event: Event, room: RoomStatus, now_s: float) -> bool:
        """Take an event in; return whether it is a word of somebody who sits in the room."""
        given = event.cue_given
        seat = next((one for one in room.seats if one.arm == given.arm), None)
        if not event.HasField("cue_given") or seat is None or given.cue not in Cue.values():
            return False
        number = event.wall_ns // 1000  # a page counts as far as 2^53
        said = SaidCue(given.arm, seat.name[:_NAME_CHARACTERS], cue_word(given.cue), number)
        self._said[given.arm] = (said, now_s + SHOWN_S)
        return True

    def shown(self, now_s: float) -> list[SaidCue]:
        """Return what is still to be shown, one word an arm."""
        self._said = {arm: told for arm, told in self._said.items() if now_s < told[1]}
        return [said for said, _ in self._said.values()]
