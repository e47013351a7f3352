"""Whoever lets go, loses track or sees nothing move stops the arm where it is, plus its stopping distance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from mart.protocol.messages import (
    HAND_FAULT_JUMP,
    HAND_FAULT_TRACKING,
    HAND_FAULT_UNSPECIFIED,
    Command,
    HandFault,
    pose_from_message,
)
from mart.protocol.pose import Pose
from mart.sim.world import World
from mart.teleop_gateway.input.driving import MAX_FRAME_AGE_NS, Driving, InputDevice
from mart.teleop_gateway.input.frame_validator import LetGo
from mart.teleop_gateway.input.phone_frame import Flag
from mart.teleop_gateway.input.picture_watch import STILL_AFTER_S
from mart.teleop_gateway.input.retarget import Retarget
from mart.teleop_gateway.input.tool_motion import ToolMotion
from tests.teleop_gateway.input.strategies import phone_frame

EPOCH = 7
FRAMES_A_TICK = 3
CONTROL_HZ = 20.0
FRAME_S = 1.0 / (CONTROL_HZ * FRAMES_A_TICK)
STOPPING_DISTANCE_M = 0.04  # measured: 16 to 34 mm at 0.27 m/s, by how late the last command is


@dataclass
class Hand:
    """What a device would send now."""

    y_m: float = 0.0
    clutch: bool = False
    tracking: bool = True
    late_s: float = 0.0


class DrivenArm:
    """An arm of a real world, driven by the frames of one device; a command is used `late_ticks` after its tick."""

    def __init__(self, device: InputDevice, late_ticks: int) -> None:
        self.world = World.build("two_arm_multi_cube_lifting", CONTROL_HZ)
        self.world.reset(seed=3)
        self.driving = Driving("arm0", EPOCH, 1_000, Retarget(0.0))
        self.driving.connect(InputDevice.KEYBOARD)
        self.driving.connect(device)
        self.driving.set_clock(device, 0)
        self.device, self.hand = device, Hand()
        self.displays = True
        self.positions = [self.tool.position]
        self._motion = ToolMotion(self.tool)
        self._now_s = 100.0
        self._frames = self._tick = 0
        self._commands: list[Command] = []
        self._late = late_ticks * FRAMES_A_TICK
        self._other = self.world.tool_pose_in_base("arm1")

    @property
    def tool(self) -> Pose:
        return self.world.tool_pose_in_base("arm0")

    def advance(self, ticks: int, to_m: float | None = None) -> None:
        """The hand goes on to `to_m` at an even speed."""
        frames = ticks * FRAMES_A_TICK
        step_m = 0.0 if to_m is None else (to_m - self.hand.y_m) / frames
        for _ in range(ticks):
            for _ in range(FRAMES_A_TICK):
                self.hand.y_m += step_m
                self._send()
            self._step()

    def told(self) -> list[HandFault]:
        """What every command so far says was lost of the hand."""
        return [command.hand_fault for command in self._commands]

    def wait(self, elapsed_s: float) -> None:
        """Nothing comes: the world waits."""
        self._now_s += elapsed_s

    def _send(self) -> None:
        self._now_s += FRAME_S
        self._frames += 1
        frame = phone_frame(
            self._frames,
            sent_us=round((self._now_s - self.hand.late_s) * 1e6),
            position=(self.hand.y_m, 0.0, 0.0),
            clutch=self.hand.clutch,
            tracking=self.hand.tracking,
            more=Flag.SCREEN_ALIGNED,
        )
        command = self.driving.receive(
            self.device, frame.encode(), self._motion, self._now_s, round(self._now_s * 1e9)
        )
        assert command is not None
        self._commands.append(command)

    def _step(self) -> None:
        command = self._commands[max(0, len(self._commands) - 1 - self._late)]
        target = pose_from_message(command.target_tool_in_base)
        other = self.world.action_for("arm1", self._other, 0.0)
        self.world.step(np.array([self.world.action_for("arm0", target, 0.0), other]))
        self._tick += 1
        self.positions.append(self.tool.position)
        self._motion = self._motion.after(self.tool, self.world.sim_time_s)
        self.driving.picture.on_state(self._tick, self._now_s)
        if self.displays:
            self.driving.picture.on_displayed(self._tick, self._now_s)


def release(arm: DrivenArm) -> None:
    arm.hand.clutch = False


def lose_track(arm: DrivenArm) -> None:
    arm.hand.tracking = False


def lose_the_link(arm: DrivenArm) -> None:
    arm.wait(5.0)


def send_what_is_old(arm: DrivenArm) -> None:
    arm.hand.late_s = 1.1 * MAX_FRAME_AGE_NS * 1e-9


def give_to_the_other_device(arm: DrivenArm) -> None:
    arm.driving.disconnect(arm.device)
    arm.device = InputDevice.KEYBOARD
    arm.driving.connect(arm.device)


def test_commands_say_what_was_lost_of_the_hand() -> None:
    arm = DrivenArm(InputDevice.PHONE, late_ticks=0)
    arm.hand.tracking = False
    arm.advance(1)
    assert set(arm.told()) == {HAND_FAULT_UNSPECIFIED}  # not started yet: there was nothing to lose
    arm.hand.tracking = True
    arm.advance(1)
    arm.hand.tracking = False
    arm.advance(1)
    arm.hand.tracking = True
    arm.advance(1)
    arm.hand.clutch = True
    arm.advance(1)
    arm.hand.y_m += 0.3
    arm.advance(1)
    faults = arm.told()[-5 * FRAMES_A_TICK :]
    lost, jumped = [HAND_FAULT_TRACKING] * FRAMES_A_TICK, [HAND_FAULT_JUMP]
    still = [HAND_FAULT_UNSPECIFIED] * FRAMES_A_TICK
    assert faults == [*still, *lost, *still, *still, *jumped, *still[1:]]


@pytest.mark.parametrize("device", list(InputDevice))
@pytest.mark.parametrize(
    ("end", "why"),
    [
        (release, None),
        (lose_track, LetGo.TRACKING),
        (lose_the_link, LetGo.GAP),
        (send_what_is_old, LetGo.AGE),
        (give_to_the_other_device, LetGo.NEW),
    ],
)
@pytest.mark.parametrize("late_ticks", [0, 2])
def test_half_a_metre_in_a_quarter_of_a_second_and_let_go(
    device: InputDevice, end: Callable[[DrivenArm], None], why: LetGo | None, late_ticks: int
) -> None:
    arm = DrivenArm(device, late_ticks)
    arm.advance(2)
    arm.hand.clutch = True
    arm.advance(5, to_m=0.5)
    assert arm.driving.engaged(arm._now_s)
    speed_m_per_s = np.linalg.norm(arm.positions[-1] - arm.positions[-2]) * CONTROL_HZ
    assert speed_m_per_s > 0.15
    moving = arm.positions[-1] - arm.positions[-2]
    let_go_at = arm.tool.position
    end(arm)
    arm.advance(30)
    assert arm.driving.let_go(arm._now_s) == why
    assert not arm.driving.engaged(arm._now_s)
    went_m = (np.array(arm.positions[-31:]) - let_go_at) @ moving / np.linalg.norm(moving)
    assert went_m.max() < STOPPING_DISTANCE_M
    assert went_m[-1] > went_m.max() - 0.002  # and not back
    assert np.linalg.norm(arm.positions[-1] - arm.positions[-2]) * CONTROL_HZ < 0.002


def test_a_picture_that_stands_still_for_a_second_stops_the_arm_until_the_clutch_is_pressed_anew() -> None:
    arm = DrivenArm(InputDevice.PHONE, late_ticks=0)
    arm.advance(2)
    arm.hand.clutch = True
    arm.advance(2, to_m=0.02)
    arm.displays = False
    arm.advance(round(STILL_AFTER_S * CONTROL_HZ), to_m=0.25)
    assert arm.driving.engaged(arm._now_s)
    arm.advance(2)
    assert arm.driving.let_go(arm._now_s) is LetGo.PICTURE
    arm.advance(10)
    stopped_at = arm.tool.position
    arm.displays = True
    arm.advance(5, to_m=0.5)  # seen again, and still held since before
    assert np.linalg.norm(arm.tool.position - stopped_at) < 0.002
    arm.hand.clutch = False
    arm.advance(1)
    arm.hand.clutch = True
    arm.advance(1)
    assert arm.driving.engaged(arm._now_s)
