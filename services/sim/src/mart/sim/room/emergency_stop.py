"""Latch a room's emergency stop: one press stops it, a person lets it go, and everybody is told who did."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mart.protocol import clock
from mart.protocol.errors import Conflict, Forbidden
from mart.protocol.messages import EmergencyStop, EpisodeRequest, Event
from mart.sim.room import room_messages
from mart.sim.room.barrier import Barrier
from mart.sim.room.driven_arms import Trouble
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
        self._troubles: set[Trouble] = set()  # that were told, of arms that are not well yet
        if pressed is not None:
            known = any(seat.arm == pressed.arm for seat in seats)
            barrier.stop(pressed.arm if known else "", now_s)

    def message(self) -> EmergencyStop | None:
        """Return who pressed, as the room's status tells it; None while no stop is on."""
        pressed = self._pressed
        if pressed is None:
            return None
        also_name = pressed.under.name if pressed.under else ""
        return EmergencyStop(**pressed.model_dump(exclude={"under"}), also_name=also_name)

    def heard(self, arm: str) -> None:
        """Take that a command for `arm` may have pressed it."""
        if self._barrier.stopped:
            self._press(self._stop(arm, self._seats[arm].driver.called))

    def press(self, request: EpisodeRequest.Stop, now_s: float) -> None:
        """Stop everything, once. A host's pause lies over a stop, and neither ends the other.

        Raises InvalidInput where the name cannot be shown, Conflict in lockstep.
        """
        require_name(request.name)
        if not self._paced:
            raise Conflict("A stop was asked of a room that runs in lockstep; end its `mart sim` instead.")
        seat = next(iter(self._seats.of_holder(request.holder_id)), None)
        self._barrier.stop(seat.arm if seat else "", now_s)
        self._press(self._stop(seat.arm if seat else "", request.name, by_host=request.by_host))

    def hear_drivers(self, troubles: Sequence[Trouble], now_s: float) -> None:
        """Stop everything while a driver is in trouble; each trouble is told once, by the names of arm and driver."""
        new = [trouble for trouble in troubles if trouble not in self._troubles]
        troubled = {trouble.arm for trouble in troubles}
        self._troubles = {one for one in self._troubles if one.arm in troubled} | set(troubles)
        for trouble in new or troubles[: 0 if self._barrier.stopped else 1]:
            name = f"Driver of {trouble.arm}" + (f" ({trouble.driver})" if trouble.driver else "")
            self._barrier.stop(trouble.arm, now_s)
            self._press(self._stop(trouble.arm, name, fault=trouble.fault))

    def let_go(self, request: EpisodeRequest.GoOn, troubles: Sequence[Trouble] = ()) -> None:
        """Let everything go on; of a stop under a host's pause, the stop stays.

        Raises Conflict where nothing is stopped or a driver is in trouble, Forbidden where a host paused and no host
        lets go, InvalidInput as `press` does.
        """
        require_name(request.name)
        pressed = self._pressed
        if pressed is None:
            raise Conflict("An emergency stop was to be let go, but none is on.")
        if troubles:
            raise Conflict(f"The driver of {troubles[0].arm} is not ready: {troubles[0].fault}")
        if pressed.by_host and not request.by_host:
            raise Forbidden(f"{pressed.name}, the host, paused this room; only a host lets it go on.")
        self._pressed = pressed.under
        did = "ended the pause" if pressed.by_host else "let go of the emergency stop"
        if pressed.under is None:
            self._barrier.let_go()
            follows = "everything goes on"
        else:
            follows = f"{pressed.under.name} had stopped everything, which holds"
        self._changed(self._pressed, room_messages.notice("info", f"{request.name} {did}: {follows}."))

    def _stop(self, arm: str, name: str, *, by_host: bool = False, fault: str = "") -> SavedStop:
        return SavedStop(arm=arm, name=name, wall_ns=clock.wall_ns(), by_host=by_host, fault=fault)

    def _press(self, new: SavedStop) -> None:
        """Latch `new`; the first of a kind is named."""
        on = self._pressed
        if on is None:
            self._latch(new, new)
        elif new.by_host and not on.by_host:
            self._latch(new.model_copy(update={"under": on}), new)
        elif on.by_host and not new.by_host and on.under is None:
            self._latch(on.model_copy(update={"under": new}), new)
        elif new.fault:
            self._latch(on, new)

    def _latch(self, pressed: SavedStop, new: SavedStop) -> None:
        self._pressed = pressed
        did = (
            "paused the room."
            if new.by_host
            else "stopped everything" + (f": {new.fault}" if new.fault else ".")
        )
        self._changed(pressed, room_messages.notice("warning", f"{new.name} {did}"))
