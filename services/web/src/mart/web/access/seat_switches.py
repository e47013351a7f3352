"""Remember who went from which seat to which, so that their phone goes with them. Pure."""

from __future__ import annotations

from collections import OrderedDict

_REMEMBERED = 256  # people and rooms


class SeatSwitches:
    """Say at which arm somebody is now whose phone was paired at another."""

    def __init__(self) -> None:
        self._now: OrderedDict[tuple[str, str], dict[str, str]] = OrderedDict()

    def note(self, room: str, holder_id: str, left: str, taken: str) -> None:
        """Take that whoever sat at the arm `left` sits at `taken` now."""
        now = self._now.setdefault((room, holder_id), {})
        self._now.move_to_end((room, holder_id))
        for paired, arm in (*now.items(), (left, left)):
            if arm == left:
                now[paired] = taken
        if len(self._now) > _REMEMBERED:
            self._now.popitem(last=False)

    def arm_of(self, room: str, holder_id: str, paired: str) -> str:
        """Return where somebody went from the arm that their phone is `paired` with; that arm where they stayed."""
        return self._now.get((room, holder_id), {}).get(paired, paired)
