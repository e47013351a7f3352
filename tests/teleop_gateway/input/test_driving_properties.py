"""Any course of hands, stops, resets and pictures: a held clutch leads the arm only where nothing speaks against it."""

from __future__ import annotations

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, rule

from mart.protocol.messages import ArmState, pose_from_message
from mart.teleop_gateway.input.driving import Driving, InputDevice
from mart.teleop_gateway.input.frame_validator import LetGo
from mart.teleop_gateway.input.phone_frame import Flag
from mart.teleop_gateway.input.picture_watch import STILL_AFTER_S
from mart.teleop_gateway.input.retarget import Retarget
from mart.teleop_gateway.input.tool_motion import ToolMotion
from tests.teleop_gateway.input.strategies import phone_frame
from tests.teleop_gateway.input.test_driving import HOME

pytestmark = pytest.mark.slow

FRAME_S = 1 / 60
devices = st.sampled_from(list(InputDevice))


class DrivingMachine(RuleBasedStateMachine):
    """`free`: whose clutch was open since anything last spoke against it. The tool never moves."""

    def __init__(self) -> None:
        super().__init__()
        self.driving = Driving("arm0", 7, 1000, Retarget(0.0))
        self.now_s, self.tick = 100.0, 0
        self.numbers = dict.fromkeys(InputDevice, 0)
        self.free: set[InputDevice] = set()
        self.grippers: dict[InputDevice, float] = {}
        self.open_by_reset = False
        for device in (InputDevice.KEYBOARD, InputDevice.PHONE):
            self.driving.connect(device)
        self._go_on(displayed=True)

    def _go_on(self, *, displayed: bool) -> None:
        self.tick += 1
        arm = ArmState(arm="arm0", gripper=0.0, action=[0.0] * 6 + [2 * self.driving.gripper - 1])
        self.driving.see(arm, self.tick, self.now_s, self.now_s)
        if displayed:
            self.driving.picture.on_displayed(self.tick, self.now_s)

    @rule(device=devices, clutch=st.booleans(), tracking=st.booleans(), gripper=st.sampled_from([0.0, 1.0]))
    def frame(self, device: InputDevice, clutch: bool, tracking: bool, gripper: float) -> None:
        self.now_s += FRAME_S
        self._go_on(displayed=True)
        self._send(device, clutch, tracking, gripper)

    @rule(device=devices)
    def hold_on(self, device: InputDevice) -> None:
        for clutch in (False, True, True):
            self.frame(device, clutch=clutch, tracking=True, gripper=self.grippers.get(device, 0.0))

    def _send(self, device: InputDevice, clutch: bool, tracking: bool, gripper: float) -> None:
        self.numbers[device] += 1
        frame = phone_frame(
            self.numbers[device],
            sent_us=int(self.now_s * 1e6),
            clutch=clutch,
            tracking=tracking,
            gripper=gripper,
            more=Flag.SCREEN_ALIGNED,
        )
        pressed = clutch and device in self.free
        changed = self.grippers.get(device, gripper) != gripper
        command = self.driving.receive(
            device, frame.encode(), ToolMotion(HOME, self.now_s), self.now_s, round(self.now_s * 1e9)
        )
        self.grippers[device] = gripper
        if not tracking:
            self.free.discard(device)
        elif not clutch:
            self.free.add(device)
        if command is None:
            assert device is not self.driving.active
            return
        if clutch and self.driving.held_by_room:
            self.free.discard(device)
        assert command.engaged <= (clutch and tracking and device in self.free)
        assert pose_from_message(command.target_tool_in_base).distance_to(HOME)[0] < 1e-9
        if self.open_by_reset and not changed and not pressed:
            assert command.gripper == 0.0
        else:
            self.open_by_reset = False

    @rule(on=st.booleans())
    def stop(self, on: bool) -> None:
        self.driving.held_by_room = LetGo.PAUSE if on else None

    @rule(device=devices)
    def select(self, device: InputDevice) -> None:
        self.driving.select(device)

    @rule()
    def reset_world(self) -> None:
        self.driving.world_was_reset()
        self.open_by_reset = True
        assert self.driving.gripper == 0.0

    @rule()
    def the_picture_stands_still(self) -> None:
        for _ in range(round((STILL_AFTER_S + 0.2) / FRAME_S)):
            self.now_s += FRAME_S
            self._go_on(displayed=False)
            for device in InputDevice:
                held = device in self.free
                self._send(device, held, True, self.grippers.get(device, 0.0))
        assert not self.driving.engaged(self.now_s)
        self.free.discard(self.driving.active)


DrivingMachine.TestCase.settings = settings(max_examples=60, stateful_step_count=30, deadline=None)
TestAnyHands = DrivingMachine.TestCase
