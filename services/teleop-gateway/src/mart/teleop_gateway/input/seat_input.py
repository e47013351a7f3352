"""Follow who holds a seat, and turn what the holder's devices send into commands for the room."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable

from mart.protocol import clock, codec, keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import BARRIER_PHASE_PAUSED, BARRIER_PHASE_STOPPED, ArmState, Command, RoomStatus
from mart.protocol.pose import Pose
from mart.runtime.bus.aio import AsyncBus
from mart.teleop_gateway.change_signal import ChangeSignal
from mart.teleop_gateway.input.driving import Driving, InputDevice
from mart.teleop_gateway.input.frame_validator import LetGo
from mart.teleop_gateway.input.retarget import Retarget
from mart.teleop_gateway.input.tool_motion import ToolMotion
from mart.teleop_gateway.served_seats import SeatAddress, served_epochs

# In which phases no hand counts: the person would drive a world that does not move, and it would jump afterwards.
_HOLDS = {BARRIER_PHASE_STOPPED: LetGo.STOP, BARRIER_PHASE_PAUSED: LetGo.PAUSE}


class SeatInput:
    """Hold the driving of the present holder; None while nobody is served, or the seat's camera is not known yet."""

    def __init__(
        self,
        bus: AsyncBus,
        seat: SeatAddress,
        *,
        hand_scale: float,
        on_command: Callable[[Command], None],
        on_new_holder: Callable[[], None],
    ) -> None:
        """Read inputs. `hand_scale`: metres of tool a metre of hand; `on_new_holder` drops the former one's peers."""
        self.driving: Driving | None = None
        self._seat = seat
        self._hand_scale = hand_scale
        self._on_command, self._on_new_holder = on_command, on_new_holder
        self._commands = bus.publisher(keys.command(seat.room, seat.arm))
        self._changed = ChangeSignal()
        self._epoch: int | None = None
        self._azimuth_rad: float | None = None
        self._tool: ToolMotion | None = None

    def close(self) -> None:
        """Publish no command any more."""
        self._commands.close()

    async def await_driving(self, epoch: int, timeout_s: float) -> Driving:
        """Return the driving of the holder of this epoch, or of the newest one that is known after `timeout_s`.

        What a token says may be newer than what the room has told here. Raises Unavailable where the room has told
        nothing.
        """
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(timeout_s):
                while self.driving is None or self.driving.seat_epoch < epoch:
                    await self._changed.wait()
        if self.driving is None:
            raise Unavailable(
                f"{self._seat.room} has not told about {self._seat.arm} yet; is its sim running?"
            )
        return self.driving

    # What the room says

    def on_status(self, status: RoomStatus) -> None:
        """Take who holds the seat, and whether everything is stopped or paused."""
        self._epoch = served_epochs(status).get(self._seat)
        self._renew()
        if self.driving is not None:
            self.driving.held_by_room = _HOLDS.get(status.barrier)

    def on_camera_azimuth(self, azimuth_rad: float) -> None:
        """Take where the seat's camera looks: a hand's motion is turned by it."""
        self._azimuth_rad = azimuth_rad
        if self.driving is not None:
            self.driving.retarget = Retarget(azimuth_rad, self._hand_scale)
        self._renew()

    def on_state(
        self, arm: ArmState, tool_in_base: Pose, tick: int, sim_time_s: float, was_reset: bool
    ) -> None:
        """Take where the arm is after the newest tick."""
        known = None if was_reset else self._tool
        self._tool = known.after(tool_in_base, sim_time_s) if known else ToolMotion(tool_in_base, sim_time_s)
        if self.driving is not None:
            self.driving.see(arm, tick, sim_time_s, clock.monotonic_s())
            if was_reset:
                self.driving.world_was_reset()

    # What is drawn, and what of it the holder's page shows

    def on_drawn(self, tick: int) -> None:
        """Take that a picture of this tick is on its way to the holder."""
        if self.driving is not None:
            self.driving.picture.on_drawn(tick, clock.monotonic_s())

    def on_displayed(self, tick: int) -> None:
        """Take that the holder's page has displayed this tick."""
        if self.driving is not None:
            self.driving.picture.on_displayed(tick, clock.monotonic_s())

    def _renew(self) -> None:
        """Begin anew for a new holder: with an empty record, and no peer of the one before."""
        if self._azimuth_rad is None:
            return
        if self.driving is not None and self.driving.seat_epoch == self._epoch:
            return
        self._on_new_holder()
        self.driving = None
        if self._epoch is not None:
            # Milliseconds since 1970: above every number of an earlier process, which sent less than 1000 a second.
            first_sequence = clock.wall_ns() // 1_000_000
            retarget = Retarget(self._azimuth_rad, self._hand_scale)
            self.driving = Driving(self._seat.arm, self._epoch, first_sequence, retarget)
        self._changed.tell()

    # What devices send; nothing of it counts while nobody holds the seat.

    def connect(self, device: InputDevice) -> None:
        """Begin to listen to a device that has just come."""
        if self.driving is not None:
            self.driving.connect(device)

    def disconnect(self, device: InputDevice) -> None:
        """Forget a device that has left."""
        if self.driving is not None:
            self.driving.disconnect(device)

    def select(self, device: InputDevice) -> None:
        """Let this device drive."""
        if self.driving is not None:
            self.driving.select(device)

    def set_clock(self, device: InputDevice, offset_ns: int) -> None:
        """Take the gateway's clock minus the device's, nanoseconds."""
        if self.driving is not None:
            self.driving.set_clock(device, offset_ns)

    def receive(self, device: InputDevice, payload: bytes) -> None:
        """Publish the command that a phone frame asks for, if it asks for one."""
        if self.driving is None:
            return
        now_s, now_ns = clock.monotonic_s(), clock.wall_ns()
        command = self.driving.receive(device, payload, self._tool, now_s, now_ns)
        if command is not None:
            command.stamps.sent_ns = clock.wall_ns()
            self._commands.put(codec.encode(command))
            self._on_command(command)
