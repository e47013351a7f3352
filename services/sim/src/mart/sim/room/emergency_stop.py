"""Latch a room's emergency stop: one press stops it, a person lets it go, and everybody is told who did."""

from __future__ import annotations

from collections.abc import Callable

from mart.protocol import clock
from mart.protocol.errors import Conflict, Forbidden
from mart.protocol.messages import EmergencyStop, EpisodeRequest, Event
from mart.sim.room import room_messages
from mart.sim.room.barrier import Barrier
from mart.sim.room.saved_room import SavedStop
from mart.sim.room.seats import SeatTable, require_name


class StopLatch:
    """Keep who pressed, over a restart of the sim too; the barrier keeps the world still.

    `changed` is told who pressed, None once it was let go, and the event that says so.
    """

    def __init__(
        self,
        barrier: Barrier,
        seats: SeatTable,
        pressed: SavedStop | None,
        changed: Callable[[SavedStop | None, Event], None],
        now_s: float,
        *,
        paced: bool = True,
    ) -> None:
        """Latch what was pressed before. A room that is not `paced` has nobody in it to be stopped for."""
        self._paced = paced
        self._barrier, self._seats, self._changed = barrier, seats, changed
        self._pressed = pressed
        if pressed is not None:
            known = any(seat.arm == pressed.arm for seat in seats)
            barrier.stop(pressed.arm if known else "", now_s)

    def message(self) -> EmergencyStop | None:
        """Return who pressed, as the room's status tells it; None while no stop is on."""
        pressed = self._pressed
        return EmergencyStop(**pressed.model_dump()) if pressed else None

    def heard(self, arm: str) -> None:
        """Take that a command for `arm` may have pressed it."""
        if self._barrier.stopped and self._pressed is None:
            self._latch(arm, self._seats[arm].driver.called)

    def press(self, request: EpisodeRequest.Stop, now_s: float) -> None:
        """Stop everything, once; what a host pauses stays a host's, also where somebody had pressed before.

        Raises InvalidInput where the name cannot be shown, Conflict in lockstep.
        """
        require_name(request.name)
        if not self._paced:
            raise Conflict("A stop was asked of a room that runs in lockstep; end its `mart sim` instead.")
        seat = next(iter(self._seats.of_holder(request.holder_id)), None)
        self._barrier.stop(seat.arm if seat else "", now_s)
        if self._pressed is None or (request.by_host and not self._pressed.by_host):
            self._latch(seat.arm if seat else "", request.name, by_host=request.by_host)

    def let_go(self, request: EpisodeRequest.GoOn) -> None:
        """Let everything go on; raises Conflict where nothing is stopped, InvalidInput as `press` does.

        Raises Forbidden where a host paused and no host lets go.
        """
        require_name(request.name)
        if self._pressed is None:
            raise Conflict("An emergency stop was to be let go, but none is on.")
        pressed, paused = self._pressed, self._pressed.by_host
        if paused and not request.by_host:
            raise Forbidden(f"{pressed.name}, the host, paused this room; only a host lets it go on.")
        self._pressed = None
        self._barrier.let_go()
        what = "ended the pause" if paused else "let go of the emergency stop"
        self._changed(None, room_messages.notice("info", f"{request.name} {what}: everything goes on."))

    def _latch(self, arm: str, name: str, *, by_host: bool = False) -> None:
        self._pressed = SavedStop(arm=arm, name=name, wall_ns=clock.wall_ns(), by_host=by_host)
        did = "paused the room." if by_host else "stopped everything."
        self._changed(self._pressed, room_messages.notice("warning", f"{name} {did}"))
