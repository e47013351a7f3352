"""Do over WebRTC exactly what the phone page does, led by an expert's intents instead of a hand."""

from __future__ import annotations

import contextlib
from typing import Any

from mart.protocol import clock, keys
from mart.protocol.messages import Command, Model, State, pose_from_message
from mart.protocol.received import decode_received
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.teleop_gateway.emulation.emulated_hand import EmulatedHand, PhoneReading, ToolIntent, resting_pose
from mart.teleop_gateway.emulation.network_emulation import EmulatedLink, LinkProfile
from mart.teleop_gateway.input.phone_frame import Flag, PhoneFrame
from mart.teleop_gateway.phones.phone_connection import Exchange, PhoneConnection, now_us
from mart.teleop_gateway.video.seat_renderer import camera_azimuth_rad, load_room_model

_MODEL_TIMEOUT_S = 10.0
_HEADING_RAD = 0.7  # people do not face along an axis
_BASE_FLAGS = Flag.TRACKING


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
        self._bus, self._scale = bus, scale
        up, down = (EmulatedLink(link or LinkProfile(), seed).carry for seed in (1, 2))
        self._connection = PhoneConnection(
            arm, exchange, self._next_frame, on_told=self._on_told, uplink=up, downlink=down
        )
        self._hand: EmulatedHand | None = None
        self._intent: ToolIntent | None = None
        self._sim_time_s = 0.0
        self._sequence = 0

    async def run(self) -> None:
        """Drive, until cancelled or replaced by another phone."""
        azimuth_rad = await self._camera_azimuth_rad()
        self._hand = EmulatedHand(azimuth_rad, resting_pose(_HEADING_RAD), self._scale)
        with contextlib.ExitStack() as stack:
            intents, states = (
                DecodingSubscriber(Command, self._on_intent),
                DecodingSubscriber(State, self._on_state),
            )
            stack.callback(self._bus.subscribe(keys.intent(self.room, self.arm).key, intents).close)
            stack.callback(self._bus.subscribe(keys.state(self.room).key, states).close)
            await self._connection.run()

    def _on_told(self, message: dict[str, Any]) -> None:
        self.told = message

    def _next_frame(self, now_s: float, since_s: float) -> PhoneFrame:
        assert self._hand is not None
        return self._frame(self._hand.move(self._intent, bool(self.told.get("engaged")), now_s, since_s))

    def _frame(self, held: PhoneReading) -> PhoneFrame:
        self._sequence += 1
        x, y, z = held.phone_in_session.position.tolist()
        qw, qx, qy, qz = held.phone_in_session.quaternion_wxyz.tolist()
        flags = _BASE_FLAGS | Flag.CLUTCH if held.clutch else _BASE_FLAGS
        seen = int(self.told.get("tick", 0))
        return PhoneFrame(
            self.seat_epoch, self._sequence, seen, now_us(), (x, y, z), (qw, qx, qy, qz), held.gripper, flags
        )

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
        answer = await self._bus.query(keys.model(self.room), b"", _MODEL_TIMEOUT_S)
        message = decode_received(Model, answer)
        return camera_azimuth_rad(load_room_model(message), self.arm)
