"""Hear a room: what it is made of, and the newest that it says."""

from __future__ import annotations

import contextlib
import threading
from functools import cached_property

from mart.protocol import clock, codec, keys
from mart.protocol.errors import NotFound, Unavailable
from mart.protocol.messages import ArmState, Model, RoomStatus, State
from mart.protocol.room_task import task_of_model
from mart.protocol.tasks import Task
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.runtime.settings import Settings

SILENT_AFTER_S = 5.0
_TIMEOUT_S = 5.0
_FIRST_STATE_S = 10.0


class RoomSubscription:
    """Follow one room over a connection of its own, until `close`.

    Raises Unavailable where no router or no such room can be reached, NotFound for an arm that the task does not have.
    """

    def __init__(self, room: str, arm: str, router: str | None = None) -> None:
        self.room, self.arm = room, arm
        self._state: State | None = None
        self._heard_s = clock.monotonic_s()
        self._arrived = threading.Condition()
        with contextlib.ExitStack() as opened:
            self._bus = opened.enter_context(
                ZenohBus.connect(router or Settings().router, wait_for_router=False)
            )
            self.model = _model(self._bus, room)
            if arm not in self.model.arms:
                raise NotFound.named(f"arm of {room}", arm, self.model.arms)
            for key, kind, take in (
                (keys.state(room).key, State, self._on_state),
                (keys.status(room).key, RoomStatus, self._on_status),
            ):
                subscription = self._bus.subscribe(key, DecodingSubscriber(kind, take))  # type: ignore[arg-type]
                opened.enter_context(contextlib.closing(subscription))
            self._opened = opened.pop_all()

    @cached_property
    def task(self) -> Task:
        """The room's task."""
        return task_of_model(self.model)

    def close(self) -> None:
        """Hear nothing more."""
        self._opened.close()

    def state(self) -> State:
        """Return the newest state, and wait for a first one; raises Unavailable where the room is silent.

        A room that stands still says so, and its newest state is what it is: old.
        """
        with self._arrived:
            if (
                not self._arrived.wait_for(lambda: self._state is not None, _FIRST_STATE_S)
                or self._state is None
            ):
                raise Unavailable(f"{self.room} has shown no state: nobody drives there, or it is stopped.")
            silent_s = clock.monotonic_s() - self._heard_s
            if silent_s > SILENT_AFTER_S:
                raise Unavailable(f"{self.room} has said nothing for {silent_s:.0f} s; see `mart rooms`.")
            return self._state

    def arm_state(self, state: State) -> ArmState:
        """Return what a state says of the arm; raises Unavailable where it says nothing."""
        found = next((arm for arm in state.arms if arm.arm == self.arm), None)
        if found is None:
            raise Unavailable(f"{self.room} has shown a state without {self.arm}.")
        return found

    def observation(self, state: State, name: str) -> list[float]:
        """Return an observation's numbers; raises Unavailable where the state lacks it."""
        found = next((one for one in state.observations if one.name == name), None)
        if found is None:
            raise Unavailable(f"{self.room} has shown a state without {name}.")
        return list(found.value)

    def _on_state(self, state: State) -> None:
        with self._arrived:
            self._state, self._heard_s = state, clock.monotonic_s()
            self._arrived.notify_all()

    def _on_status(self, _status: RoomStatus) -> None:
        self._heard_s = clock.monotonic_s()


def _model(bus: ZenohBus, room: str) -> Model:
    try:
        return codec.decode(Model, bus.query(keys.model(room), b"", _TIMEOUT_S))
    except Unavailable as error:
        raise Unavailable(
            f"{room} cannot be reached: {error} `mart rooms` lists those that are open."
        ) from error
