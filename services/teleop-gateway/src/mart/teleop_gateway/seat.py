"""One seat: its peers drive its arm and see its view; a policy's is watched only. Lives in a process of its own."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Awaitable, Callable

from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput, MartError, Unavailable
from mart.protocol.messages import (
    Answer,
    ArmState,
    Offer,
    RoomStatus,
    State,
    error_message,
    pose_from_message,
)
from mart.protocol.pose import Pose
from mart.protocol.tokens import Role
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Bus, Closable
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.runtime.rate_limit import RateLimit
from mart.teleop_gateway.input.cues import CueFilter
from mart.teleop_gateway.input.driving import Driving, InputDevice
from mart.teleop_gateway.input.retarget import Retarget
from mart.teleop_gateway.process.seat_process_protocol import SERVED, SeatAssignment
from mart.teleop_gateway.seat_events import SeatEvents
from mart.teleop_gateway.settings import GatewaySettings
from mart.teleop_gateway.video.encoder import Codec
from mart.teleop_gateway.video.live_view import SeatPicture
from mart.teleop_gateway.video.motion_to_photon import MotionToPhoton
from mart.teleop_gateway.video.quality import QUALITIES
from mart.teleop_gateway.video.thumbnail import Thumbnail
from mart.teleop_gateway.video.video_publisher import VideoPublisher
from mart.teleop_gateway.video.view_manager import ViewManager
from mart.teleop_gateway.webrtc import status_channel
from mart.teleop_gateway.webrtc.authorization import authorize_offer
from mart.teleop_gateway.webrtc.peer import MAX_SDP_CHARACTERS, Peer
from mart.teleop_gateway.webrtc.peers import Peers

_log = logging.getLogger(__name__)

STATUS_EVERY_S = 0.05
MAX_OFFERS_PER_S = 5
_READY_TIMEOUT_S = 5.0
_MAX_OFFER_BYTES = MAX_SDP_CHARACTERS + 4096
_INPUTS = {Role.BROWSER: InputDevice.KEYBOARD, Role.PHONE: InputDevice.PHONE}


class Seat:
    """`video_bus` is a session of its own: pictures must never stand in a command's way."""

    def __init__(
        self,
        bus: AsyncBus,
        video_bus: Bus,
        settings: GatewaySettings,
        assignment: SeatAssignment,
        secret: bytes,
    ) -> None:
        self.id = assignment.id
        self.room, self.arm = room, arm = assignment.room, assignment.arm
        self._bus, self._settings, self._secret = bus, settings, secret
        self._loop = asyncio.get_running_loop()
        self._commands = bus.publisher(keys.command(room, arm))
        self._events = SeatEvents(bus, room, arm)
        self._cues = CueFilter()
        self._video = VideoPublisher(video_bus, room, arm)
        look = QUALITIES[settings.quality]
        self._views = ViewManager(
            bus, room, arm, sink=self._on_picture, on_azimuth=self._on_azimuth, quality=look
        )
        self._peers = Peers(bus, self, settings.ice_servers)
        self._offers = RateLimit(MAX_OFFERS_PER_S)
        self._latency = MotionToPhoton(arm)
        self._ready = asyncio.Event()
        self._status = RoomStatus()
        self._state = State()
        self._measured: Pose | None = None
        self._azimuth_rad: float | None = None
        self._driving: Driving | None = None
        self._told: tuple[object, ...] = ()

    async def run(self) -> None:
        """Until cancelled."""
        with contextlib.ExitStack() as stack:
            for opened in self._open():
                stack.callback(opened.close)
            try:
                await asyncio.gather(self._tell_periodically(), self._events.report(self._latency))
            finally:
                await self._peers.close()
                await self._views.close()
                self._log_latency()

    def _open(self) -> list[Closable]:
        room, arm, bus = self.room, self.arm, self._bus
        served = [bus.serve(keys.signal(room, arm, role), self._answering(role)) for role in Role]
        status = bus.subscribe(keys.status(room).key, DecodingSubscriber(RoomStatus, self._on_room_status))
        # Not over the event loop: the view's thread must have the state before the loop finds time for it.
        state = bus.bus.subscribe(keys.state(room).key, DecodingSubscriber(State, self._on_state_arrival))
        # Last: whoever sees this token may send an offer.
        alive = bus.bus.announce(keys.alive(ServiceKind.SEAT, self.id))
        return [*served, status, state, self._commands, self._events, self._video, alive]

    # Signalling

    def _answering(self, role: Role) -> Callable[[bytes], Awaitable[bytes]]:
        async def answer(payload: bytes) -> bytes:
            try:
                return codec.encode(Answer(sdp=await self._answer(role, payload)))
            except MartError as error:
                _log.info("An offer of a %s was refused: %s", role, error)
                return codec.encode(Answer(error=error_message(error)))

        return answer

    async def _answer(self, role: Role, payload: bytes) -> str:
        if not self._offers.allows(clock.monotonic_s()):
            raise Unavailable(
                f"More than {MAX_OFFERS_PER_S} offers a second came for this seat; wait a moment."
            )
        offer = codec.decode(Offer, payload, limit_bytes=_MAX_OFFER_BYTES)
        try:
            async with asyncio.timeout(_READY_TIMEOUT_S):
                driving = await self._await_driving()
        except TimeoutError as error:
            raise Unavailable(
                f"{self.room} has not told about {self.arm} yet; is its sim running?"
            ) from error
        authorize_offer(
            offer.token, self._secret, room=self.room, arm=self.arm, epoch=driving.seat_epoch, role=role
        )
        return await self._peers.answer(role, offer.sdp)

    async def _await_driving(self) -> Driving:
        while self._driving is None:
            await self._ready.wait()
        return self._driving

    # What peers do

    def on_joined(self, peer: Peer) -> None:
        _log.info("%s %s: a %s joined", self.room, self.arm, peer.role)
        self._views.set_codecs(self._peers.codecs())
        if self._driving is not None and peer.role in _INPUTS:
            self._driving.connect(_INPUTS[peer.role])

    def on_left(self, peer: Peer) -> None:
        _log.info("%s %s: a %s left", self.room, self.arm, peer.role)
        self._views.set_codecs(self._peers.codecs())
        if self._driving is not None and peer.role in _INPUTS:
            self._driving.disconnect(_INPUTS[peer.role])

    def on_pose(self, peer: Peer, payload: bytes) -> None:
        if self._driving is None:
            return
        now_s, now_ns = clock.monotonic_s(), clock.wall_ns()
        command = self._driving.receive(_INPUTS[peer.role], payload, self._measured, now_s, now_ns)
        if command is not None:
            command.stamps.sent_ns = clock.wall_ns()
            self._commands.put(codec.encode(command))
            self._latency.on_command(command)
            self._tell_changes()

    def on_status(self, peer: Peer, text: str) -> None:
        try:
            message = status_channel.parse(text)
        except InvalidInput as error:
            _log.debug("A %s said what nobody understands: %s", peer.role, error)
            return
        match message:
            case status_channel.PingMessage():
                peer.send_status(status_channel.pong(message, clock.wall_ns()))
            case status_channel.ClockMessage(offset_ns):
                self._set_clock(peer, offset_ns)
            case status_channel.SeenMessage(tick, t_us) if (
                peer.role is Role.BROWSER and peer.clock_offset_ns is not None
            ):
                self._latency.on_seen(tick, int(t_us * 1000) + peer.clock_offset_ns)
            case status_channel.SelectInputMessage(chosen) if (
                peer.role in _INPUTS and self._driving is not None
            ):
                self._driving.select(chosen)
                self._tell_changes()
            case status_channel.CueMessage(cue, press_us) if peer.role in _INPUTS:
                if self._cues.admit(press_us, clock.monotonic_s()):
                    self._events.cue(cue)

    def on_keyframe_wanted(self, codec: Codec) -> None:
        self._views.request_keyframe(codec)

    def _set_clock(self, peer: Peer, offset_ns: int) -> None:
        peer.clock_offset_ns = offset_ns
        if self._driving is not None and peer.role in _INPUTS:
            self._driving.set_clock(_INPUTS[peer.role], offset_ns)

    # What the room does

    def _on_state_arrival(self, state: State) -> None:
        """On the bus's thread."""
        received_ns = clock.wall_ns()
        for arm in state.arms:
            if arm.arm == self.arm:
                measured = pose_from_message(arm.tool_in_base)
                self._views.offer(state, received_ns)
                self._loop.call_soon_threadsafe(self._on_state, state, arm, measured)

    def _on_state(self, state: State, arm: ArmState, measured_tool_in_base: Pose) -> None:
        was_reset = state.boot != self._state.boot or state.sim_time_s < self._state.sim_time_s
        self._state = state
        self._events.tick = state.tick
        self._measured = measured_tool_in_base
        if self._driving is not None:
            self._driving.see(arm, state.sim_time_s)
            if was_reset:
                self._driving.world_was_reset()
        self._views.on_boot(state.boot)
        if self._status.control_hz:
            self._latency.on_state(state, self._status.control_hz)

    def _on_room_status(self, status: RoomStatus) -> None:
        self._status = status
        self._renew_driving()
        self._tell_changes()

    def _on_azimuth(self, azimuth_rad: float) -> None:
        self._azimuth_rad = azimuth_rad
        if self._driving is not None:
            self._driving.retarget = Retarget(azimuth_rad, self._settings.hand_scale)
        self._renew_driving()

    def _renew_driving(self) -> None:
        """A new holder drives anew: with an empty record, and no peer of the one before."""
        if self._azimuth_rad is None:
            return
        epoch = next(
            (s.epoch for s in self._status.seats if s.arm == self.arm and s.operator in SERVED), None
        )
        if self._driving is not None and self._driving.seat_epoch == epoch:
            return
        self._peers.drop_driving()
        if epoch is None:
            self._driving = None
            self._ready.clear()
            return
        # Milliseconds since 1970: above every number of an earlier process, which sent less than 1000 a second.
        first_sequence = clock.wall_ns() // 1_000_000
        retarget = Retarget(self._azimuth_rad, self._settings.hand_scale)
        self._driving = Driving(self.arm, epoch, first_sequence, retarget)
        self._ready.set()

    # What is told

    async def _tell_periodically(self) -> None:
        while True:
            self._tell(clock.monotonic_s())
            self._peers.drop_silent(clock.monotonic_s())
            await asyncio.sleep(STATUS_EVERY_S)

    def _tell_changes(self) -> None:
        now_s = clock.monotonic_s()
        if self._driving is not None and self._told != self._telling(self._driving, now_s):
            self._tell(now_s)

    def _tell(self, now_s: float) -> None:
        if self._driving is None:
            return
        self._told = self._telling(self._driving, now_s)
        latency, frames_per_s = self._latency.summary(), self._views.frames_per_s()
        self._peers.tell(
            status_channel.tick(
                self._state, self._status, self._driving, now_s, latency=latency, frames_per_s=frames_per_s
            )
        )

    def _telling(self, driving: Driving, now_s: float) -> tuple[object, ...]:
        """What is worth a message of its own."""
        waiting = tuple(waiting.arm for waiting in self._status.waiting_for)
        return driving.engaged(now_s), driving.holding, driving.active, self._status.barrier, waiting

    def _on_picture(self, made: SeatPicture | Thumbnail) -> None:
        """On the view's thread: first to those who wait for it, then onto the bus."""
        if isinstance(made, SeatPicture):
            self._loop.call_soon_threadsafe(self._pass_on, made)
        self._video.put(made)

    def _pass_on(self, picture: SeatPicture) -> None:
        self._peers.put(picture.encoded)
        if picture.encoded.codec is Codec.H264:
            self._latency.on_picture(picture.tick, picture.stamps)

    def _log_latency(self) -> None:
        summary = self._latency.summary()
        if summary is not None:
            _log.info("%s %s motion to photon: %s", self.room, self.arm, summary)
