"""Hand what a room says, its states and its status, to the parts of one seat."""

from __future__ import annotations

import asyncio

from mart.protocol import clock, keys
from mart.protocol.messages import ArmState, Event, RoomStatus, State, pose_from_message
from mart.protocol.pose import Pose
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Closable
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.teleop_gateway.input.seat_input import SeatInput
from mart.teleop_gateway.seat_events import SeatEvents
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.video.camera_feed import CameraFeed
from mart.teleop_gateway.video.motion_to_photon import MotionToPhoton
from mart.teleop_gateway.video.page_drawing import PageDrawing
from mart.teleop_gateway.video.view_manager import ViewManager
from mart.teleop_gateway.webrtc.status_broadcaster import StatusBroadcaster


class RoomFeed:
    """Listen to one room for one seat. Both kinds of message are repeated by the room, so a lost one costs nothing."""

    def __init__(
        self,
        seat: SeatAddress,
        *,
        seat_input: SeatInput,
        views: ViewManager,
        cameras: CameraFeed,
        pages: PageDrawing,
        latency: MotionToPhoton,
        events: SeatEvents,
        broadcaster: StatusBroadcaster,
    ) -> None:
        self._seat = seat
        self._input, self._views, self._latency = seat_input, views, latency
        self._cameras = cameras
        self._pages = pages
        self._events, self._broadcaster = events, broadcaster
        self._loop = asyncio.get_running_loop()

    def subscribe(self, bus: AsyncBus) -> list[Closable]:
        """Listen until what is returned is closed."""
        on_status = DecodingSubscriber(RoomStatus, self._on_status)
        on_event = DecodingSubscriber(Event, self._broadcaster.on_event)
        on_state = DecodingSubscriber(State, self._on_state_arrival)
        return [
            bus.subscribe(keys.status(self._seat.room).key, on_status),
            bus.subscribe(keys.event(self._seat.room).key, on_event),
            # Not over the event loop: the view's thread must have the state before the loop finds time for it.
            bus.bus.subscribe(keys.state(self._seat.room).key, on_state),
        ]

    def _on_status(self, status: RoomStatus) -> None:
        self._broadcaster.status = status
        self._cameras.on_status(status)
        self._input.on_status(status)
        self._broadcaster.rest_where_unneeded()
        self._broadcaster.tell_changes()

    def _on_state_arrival(self, state: State) -> None:
        """Take a state on the bus's thread, and pass it on to the event loop."""
        received_ns = clock.wall_ns()
        for arm in state.arms:
            if arm.arm == self._seat.arm:
                self._cameras.on_state(state)
                tool_in_base = pose_from_message(arm.tool_in_base)
                self._views.offer(state, received_ns)
                self._pages.offer(state, received_ns)
                self._loop.call_soon_threadsafe(self._on_state, state, arm, tool_in_base)

    def _on_state(self, state: State, arm: ArmState, tool_in_base: Pose) -> None:
        before = self._broadcaster.state
        was_reset = state.boot != before.boot or state.sim_time_s < before.sim_time_s
        self._broadcaster.state = state
        self._events.tick = state.tick
        self._input.on_state(arm, tool_in_base, state.tick, state.sim_time_s, was_reset)
        if (
            self._broadcaster.status.room
        ):  # it says whether there are cameras, in whose place nothing is drawn
            self._views.on_boot(state.boot)
        control_hz = self._broadcaster.status.control_hz
        if control_hz:
            self._latency.on_state(state, control_hz)
