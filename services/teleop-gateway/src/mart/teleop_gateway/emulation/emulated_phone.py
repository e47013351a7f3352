"""Do over WebRTC exactly what the phone page does, led by an expert's intents instead of a hand."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
from collections import deque
from collections.abc import Awaitable, Callable
from typing import Any

from aiortc import RTCConfiguration, RTCDataChannel, RTCPeerConnection, RTCSessionDescription

from mart.protocol import clock, keys
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import Command, Model, State, pose_from_message
from mart.protocol.received import decode_received
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.teleop_gateway.emulation.emulated_hand import EmulatedHand, PhoneReading, ToolIntent, resting_pose
from mart.teleop_gateway.emulation.network_emulation import EmulatedLink, LinkProfile
from mart.teleop_gateway.input.phone_frame import Flag, PhoneFrame
from mart.teleop_gateway.video.seat_renderer import camera_azimuth_rad, load_room_model
from mart.teleop_gateway.webrtc import status_channel

_log = logging.getLogger(__name__)

FRAMES_PER_S = 60.0
_PING_EVERY_S = 1.0
_PINGS = 8
_CONNECT_TIMEOUT_S = 10.0
_SILENT_S = 2.0
_RETRY_S = 0.5
_HEADING_RAD = 0.7  # people do not face along an axis
_BASE_FLAGS = Flag.TRACKING

Exchange = Callable[[str], Awaitable[str]]  # an offer's SDP → the answer's; raises MartError


class EmulatedPhone:
    """Drive one seat as a phone does. `exchange` is how a page signals; the bus is for intents, states and the model.

    `scale` must be the gateway's.
    """

    def __init__(
        self,
        bus: AsyncBus,
        exchange: Exchange,
        *,
        room: str,
        arm: str,
        seat_epoch: int,
        link: LinkProfile | None = None,
        scale: float = 1.0,
    ) -> None:
        self.room, self.arm, self.seat_epoch = room, arm, seat_epoch
        self.told: dict[str, Any] = {}  # the newest status message
        self._bus, self._exchange, self._scale = bus, exchange, scale
        self._uplink, self._downlink = (EmulatedLink(link or LinkProfile(), seed) for seed in (1, 2))
        self._hand: EmulatedHand | None = None
        self._intent: ToolIntent | None = None
        self._sim_time_s = 0.0
        self._sequence = 0
        self._pings: deque[tuple[float, int]] = deque(maxlen=_PINGS)  # round trip in us, offset in ns
        self._heard_s = 0.0
        self._replaced = False

    async def run(self) -> None:
        """Connect, drive, and connect anew when that breaks, until cancelled or replaced by another phone."""
        azimuth_rad = await self._camera_azimuth_rad()
        self._hand = EmulatedHand(azimuth_rad, resting_pose(_HEADING_RAD), self._scale)
        with contextlib.ExitStack() as stack:
            intents, states = (
                DecodingSubscriber(Command, self._on_intent),
                DecodingSubscriber(State, self._on_state),
            )
            stack.callback(self._bus.subscribe(keys.intent(self.room, self.arm).key, intents).close)
            stack.callback(self._bus.subscribe(keys.state(self.room).key, states).close)
            while not self._replaced:
                try:
                    await self._drive_once(self._hand)
                except MartError as error:
                    _log.warning("The phone of %s is not connected: %s", self.arm, error)
                await asyncio.sleep(_RETRY_S)
            _log.info("Another phone drives %s now", self.arm)

    async def _drive_once(self, hand: EmulatedHand) -> None:
        """Hold one connection, until it breaks."""
        connection = RTCPeerConnection(RTCConfiguration([]))
        try:
            pose = _lossy(connection, "pose")
            status = _lossy(connection, "status")
            status.on("message", lambda text: self._downlink.carry(lambda: self._on_status(text, status)))
            await self._connect(connection, pose)
            self._heard_s = clock.monotonic_s()
            _log.info("The phone of %s is connected", self.arm)
            pinging = asyncio.ensure_future(self._ping(status))
            try:
                await self._send_frames(hand, pose)
            finally:
                pinging.cancel()
        finally:
            await connection.close()

    async def _connect(self, connection: RTCPeerConnection, pose: RTCDataChannel) -> None:
        opened = asyncio.Event()
        pose.on("open", opened.set)
        await connection.setLocalDescription(await connection.createOffer())
        answer = await self._exchange(connection.localDescription.sdp)
        await connection.setRemoteDescription(RTCSessionDescription(answer, "answer"))
        try:
            async with asyncio.timeout(_CONNECT_TIMEOUT_S):
                await opened.wait()
        except TimeoutError as error:
            raise Unavailable(f"No connection came up within {_CONNECT_TIMEOUT_S:g} s.") from error

    async def _send_frames(self, hand: EmulatedHand, pose: RTCDataChannel) -> None:
        before_s = clock.monotonic_s()
        due_s = before_s
        while pose.readyState == "open":
            now_s = clock.monotonic_s()
            if now_s - self._heard_s > _SILENT_S:
                raise Unavailable(f"The gateway has said nothing for {_SILENT_S:g} s.")
            held = hand.move(self._intent, bool(self.told.get("engaged")), now_s, now_s - before_s)
            frame = self._frame(held).encode()
            self._uplink.carry(lambda frame=frame: _send(pose, frame))  # type: ignore[misc]
            before_s = now_s
            due_s = max(due_s + 1.0 / FRAMES_PER_S, now_s)
            await asyncio.sleep(due_s - now_s)

    def _frame(self, held: PhoneReading) -> PhoneFrame:
        self._sequence += 1
        x, y, z = held.phone_in_session.position.tolist()
        qw, qx, qy, qz = held.phone_in_session.quaternion_wxyz.tolist()
        flags = _BASE_FLAGS | Flag.CLUTCH if held.clutch else _BASE_FLAGS
        seen = int(self.told.get("tick", 0))
        return PhoneFrame(
            self.seat_epoch, self._sequence, seen, _now_us(), (x, y, z), (qw, qx, qy, qz), held.gripper, flags
        )

    # The status channel

    async def _ping(self, status: RTCDataChannel) -> None:
        while True:
            text = status_channel.ping(_now_us())
            self._uplink.carry(lambda text=text: _send(status, text))  # type: ignore[misc]
            await asyncio.sleep(_PING_EVERY_S)

    def _on_status(self, text: str, status: RTCDataChannel) -> None:
        self._heard_s = clock.monotonic_s()
        message = json.loads(text)
        if message["type"] == "tick":
            self.told = message
        elif message["type"] == "pong":
            self._on_pong(message, status)
        elif message["type"] == "replaced":
            self._replaced = True

    def _on_pong(self, message: dict[str, Any], status: RTCDataChannel) -> None:
        """Tell the clock offset of the fastest of the last pings: half of its way is the least wrong."""
        now_us = _now_us()
        middle_us = (message["t_us"] + now_us) / 2
        self._pings.append((now_us - message["t_us"], int(message["gateway_ns"] - middle_us * 1000)))
        offset_ns = min(self._pings)[1]
        self._uplink.carry(lambda: _send(status, status_channel.clock_offset(offset_ns)))

    # The bus

    def _on_intent(self, command: Command) -> None:
        self._intent = ToolIntent(
            pose_from_message(command.target_tool_in_base), command.gripper, command.engaged
        )

    def _on_state(self, state: State) -> None:
        assert self._hand is not None
        now_s = clock.monotonic_s()
        if state.sim_time_s < self._sim_time_s:
            self._hand.world_was_reset(now_s)
            self._intent = None
        self._sim_time_s = state.sim_time_s
        for arm in state.arms:
            if arm.arm == self.arm:
                self._hand.see(pose_from_message(arm.tool_in_base), now_s)

    async def _camera_azimuth_rad(self) -> float:
        answer = await self._bus.query(keys.model(self.room), b"", _CONNECT_TIMEOUT_S)
        message = decode_received(Model, answer)
        return camera_azimuth_rad(message, load_room_model(message), self.arm)


def _lossy(connection: RTCPeerConnection, label: str) -> RTCDataChannel:
    return connection.createDataChannel(label, ordered=False, maxRetransmits=0)


def _send(channel: RTCDataChannel, message: bytes | str) -> None:
    if channel.readyState == "open":
        channel.send(message)


def _now_us() -> int:
    return clock.monotonic_ns() // 1000
