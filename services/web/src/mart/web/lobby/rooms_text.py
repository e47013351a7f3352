"""The rooms as the text that pages are sent, made once for all who see the same. Times are monotonic seconds."""

from __future__ import annotations

import json

from mart.web.lobby.lobby import Lobby

FRESH_S = 0.5  # without any change: then a room may have gone silent
_ANYBODY = ""


class RoomsText:
    """Keeps the newest text for each view of a lobby: everybody without a seat has the same."""

    def __init__(self, lobby: Lobby) -> None:
        self._lobby = lobby
        self._texts: dict[str, str] = {}
        self._changes = -1
        self._made_s = 0.0

    def text(self, holder_id: str, now_s: float) -> str:
        """Return the rooms as the user with `holder_id` sees them, a message of the live socket."""
        changes = self._lobby.listeners.changes
        if changes != self._changes or now_s - self._made_s > FRESH_S:
            self._texts.clear()
            self._changes, self._made_s = changes, now_s
        viewer = holder_id if self._lobby.rooms.seats_of(holder_id, now_s) else _ANYBODY
        if viewer not in self._texts:
            rooms = {"rooms": self._lobby.rooms_json(viewer, now_s)}
            self._texts[viewer] = json.dumps(rooms, separators=(",", ":"), ensure_ascii=False)
        return self._texts[viewer]
