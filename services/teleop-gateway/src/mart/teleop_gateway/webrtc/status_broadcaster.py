"""Tell every peer of a seat how the room, the arm and its driving stand: 20 times a second, and at once on a change."""

from __future__ import annotations

import asyncio
import itertools

from mart.protocol import clock
from mart.protocol.messages import Event, RoomStatus, State
from mart.teleop_gateway.input.driving import Driving
from mart.teleop_gateway.input.seat_input import SeatInput
from mart.teleop_gateway.video.camera_feed import CameraFeed
from mart.teleop_gateway.video.motion_to_photon import MotionToPhoton
from mart.teleop_gateway.video.recorded_view import RecordedView
from mart.teleop_gateway.video.view_manager import ViewManager
from mart.teleop_gateway.webrtc import status_channel
from mart.teleop_gateway.webrtc.peers import Peers
from mart.teleop_gateway.webrtc.said_cues import SaidCues

STATUS_EVERY_S = 0.05
_CUES_EVERY = 4  # statuses


class StatusBroadcaster:
    """Keep the newest state and status of the room, and tell peers of them. Give it both as they come."""

    def __init__(
        self,
        peers: Peers,
        seat_input: SeatInput,
        views: ViewManager,
        cameras: CameraFeed,
        latency: MotionToPhoton,
    ) -> None:
        self._cameras = cameras
        self.state = State()
        self.status = RoomStatus()
        self._peers, self._input, self._views, self._latency = peers, seat_input, views, latency
        self.recorded_view = RecordedView()
        self._told: tuple[object, ...] = ()
        self._cues = SaidCues()

    def rest_where_unneeded(self) -> None:
        """Let the view rest where all who look draw by themselves, and no file has begun with what it sees."""
        all_draw = self._peers.any_draws and not self._peers.streams()
        self.recorded_view.see(self.status.episode.phase, all_draw=all_draw)
        self._views.set_resting(all_draw and not self.recorded_view.is_wanted)

    async def run(self) -> None:
        """Tell until cancelled; peers that have been silent for too long are dropped on the way."""
        for number in itertools.count():
            now_s = clock.monotonic_s()
            self._tell(now_s)
            if number % _CUES_EVERY == 0:
                self._tell_cues(now_s)
            self._peers.drop_silent(now_s)
            await asyncio.sleep(STATUS_EVERY_S)

    def on_event(self, event: Event) -> None:
        """Tell phones at once what somebody says to the partners; as long as it is shown, they are told again."""
        now_s = clock.monotonic_s()
        if self._cues.take(event, self.status, now_s):
            self._tell_cues(now_s)

    def tell_changes(self) -> None:
        """Tell now, if something is worth a message of its own."""
        now_s = clock.monotonic_s()
        driving = self._input.driving
        if driving is not None and self._told != self._worth_telling(driving, now_s):
            self._tell(now_s)

    def _tell(self, now_s: float) -> None:
        driving = self._input.driving
        if driving is None:
            return
        self._told = self._worth_telling(driving, now_s)
        latency, frames_per_s = self._latency.summary(), self._views.frames_per_s()
        is_moved = driving.engaged(now_s)
        self._peers.tell(
            status_channel.tick(
                self.state,
                self.status,
                driving,
                now_s,
                latency=latency,
                frames_per_s=frames_per_s,
                no_picture=self._views.failure() or self._cameras.darkness(now_s),
                camera=self._cameras.shown,
                tools=self._views.tool_places(self.state),
                tool_view=self._views.tool_view(self.state) if is_moved else None,
            )
        )

    def _tell_cues(self, now_s: float) -> None:
        if said := self._cues.shown(now_s):
            self._peers.tell_phones(status_channel.cues(said))

    def _worth_telling(self, driving: Driving, now_s: float) -> tuple[object, ...]:
        waiting = tuple(waiting.arm for waiting in self.status.waiting_for)
        engaged = driving.engaged(now_s), driving.let_go(now_s)
        return engaged, driving.holding, driving.active, self.status.barrier, waiting
