"""Hold a live room, and open it anew at another rate between two episodes.

A room at another rate is what it would be after a restart of its sim with that rate: another compiled model, another
`boot`, by which everybody who keeps something of a room tells that it is out of date. Who sits where and what was
counted stays; ticks count on.
"""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable
from typing import Protocol

from mart.protocol.messages import RoomStatus
from mart.sim.room import room_messages
from mart.sim.room.automatic_rate import AutomaticRate
from mart.sim.room.room import Room
from mart.sim.room.room_server import RoomServer
from mart.sim.room.saved_room import SavedRoom
from mart.sim.world import World

_log = logging.getLogger(__name__)


class MakeRoom(Protocol):
    """Make a room of this world and record, which says at once how it is and goes on from how another stood."""

    def __call__(
        self,
        world: World,
        record: SavedRoom,
        keep: Callable[[SavedRoom], None],
        now_s: float,
        before: RoomStatus,
    ) -> Room: ...


class LiveRoom:
    """Hold the room that is served and its world. `rate`: None where the rate was given, which is never changed.

    keep: puts down what must survive a crash; may raise OSError.
    """

    def __init__(
        self,
        world: World,
        record: SavedRoom,
        make: MakeRoom,
        keep: Callable[[SavedRoom], None],
        now_s: float,
        *,
        rate: AutomaticRate | None = None,
    ) -> None:
        self.world = world
        self._record, self._make, self._keep, self._rate = record, make, keep, rate
        self._server: RoomServer | None = None
        self._rejected = Counter[str]()
        self.room = make(world, record, self._remember, now_s, RoomStatus())

    @property
    def rejected(self) -> Counter[str]:
        """Count the commands that were not used since the sim began, by reason."""
        return self._rejected + Counter[str](self.room.rejected)

    def serve_by(self, server: RoomServer) -> None:
        """Let this server know when another room takes its place."""
        self._server = server

    def advance(self, now_s: float) -> float:
        """Do what is due; return the time at which to call again if nothing arrives before."""
        self._change_rate(now_s)
        next_s = self.room.advance(now_s)
        return now_s if self._change_rate(now_s) else next_s

    def _change_rate(self, now_s: float) -> bool:
        if self._rate is None or not self._rate.may_change(now_s):
            return False
        self._rate.see_status(
            self.room.status(now_s), now_s
        )  # an episode may have been asked for since the last
        said = self._rate.change(now_s)
        if said is None:
            return False
        self._rejected = self.rejected
        self.world = self.world.at(self._rate.control_hz)
        if self._server is not None:  # whoever hears of the new room may ask for its model at once
            self._server.show(self.world)
        before = self.room.status(now_s)
        self.room = self._make(self.world, self._record, self._remember, now_s, before)
        if self._server is not None:
            self._server.use(self.room)
        self.room.tell(room_messages.notice("info", said))
        _log.info("%s", said)
        return True

    def _remember(self, record: SavedRoom) -> None:
        if self._rate is not None:
            record = record.with_changes(picture_s=self._rate.picture_s)
        self._record = record
        self._keep(record)
