"""Keep a world in which some arms are real: their joints are led to where drivers measured them.

Over the substeps of a tick an arm that is driven goes from its last measured joint positions to the newest ones,
whatever touches it; its fingers are pressed towards the measured opening by their servos, so that what they hold in the
world is held by friction as ever. The other arms and all things are simulated.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import mujoco
import numpy as np

from mart.protocol.pose import Pose, quaternion_exp, quaternion_multiply
from mart.protocol.tasks import Arm, gripper_observation
from mart.sim.scene.data import Array
from mart.sim.scene.gripper import stroke_m
from mart.sim.tasks import scene_of
from mart.sim.world.world import World

_OSC_OFF = 0.0
_LARGEST_MOVE_RAD = 0.35  # in a tick; what is further away was not seen to go there, and is put there
_SQUEEZE_M = 0.015  # beyond what is measured, where the gripper is told to close: the servos' full force
_CLOSES = 0.5


@dataclass(frozen=True, eq=False)
class ArmReading:
    """Hold what a driver measured: joint positions, radians, and gripper, 0 open … 1 closed."""

    joint_positions: Array
    gripper: float


class DriverLink(Protocol):
    """Read and command the arms that drivers drive."""

    @property
    def arms(self) -> Sequence[str]:
        """Return their names."""

    def reading(self, arm: str) -> ArmReading | None:
        """Return the newest reading of an arm; None before the first."""

    def aim(self, arm: str, tool_in_base: Pose, gripper: float) -> None:
        """Take where an arm is to go in the tick that begins, or is to stand after a reset."""


class DrivenWorld(World):
    """Step the same task as `world` with arms that drivers drive; it has a state of its own."""

    def __init__(self, world: World, link: DriverLink) -> None:
        super().__init__(scene_of(world.task), world.control_hz, compiled=copy.copy(world.model))
        self._link = link
        self._driven = {arm: _DrivenJoints(self.model, self.data, self.task.arm(arm)) for arm in link.arms}
        self._indices = {arm: self.arms.index(arm) for arm in link.arms}

    def at(self, control_hz: float) -> World:
        """Return the same world in ticks of another rate, with the same drivers; see `World.at`."""
        return DrivenWorld(super().at(control_hz), self._link)

    def reset(self, seed: int) -> None:
        """Place things as by this seed; arms that are driven stay where they are measured, and are told to stand."""
        super().reset(seed)
        for arm, joints in self._driven.items():
            self._interface.modes[self._indices[arm]] = _OSC_OFF
            joints.rest(self._link.reading(arm))
        mujoco.mj_forward(self.model, self.data)
        for arm in self._driven:
            self._link.aim(arm, self.tool_pose_in_base(arm), self.gripper(arm))

    def gripper(self, arm: str) -> float:
        """Return how far the gripper is measured to be closed, 0 open … 1 closed."""
        reading = self._link.reading(arm) if arm in self._driven else None
        return super().gripper(arm) if reading is None else reading.gripper

    def observations(self) -> dict[str, Array]:
        """Return all that any operator sees, in the catalogue's order; of a driven arm what was measured."""
        seen = super().observations()
        for name in map(gripper_observation, self._driven):
            if name in seen:
                seen[name] = np.array([self.gripper(name.partition("/")[0])])
        return seen

    def _advance(self, actions: Array) -> None:
        for arm, index in self._indices.items():
            self._interface.modes[index] = _OSC_OFF
            self._link.aim(arm, *self._target(arm, actions[index]))
            self._driven[arm].begin(self._link.reading(arm), closes=bool(actions[index, 6] > 0.0))
        period_s = self.control_period_s
        for substep in range(self.substeps):
            for joints in self._driven.values():
                joints.lead(substep / self.substeps, period_s)
            mujoco.mj_step(self.model, self.data)
        for joints in self._driven.values():
            joints.lead(1.0, period_s)

    def _target(self, arm: str, action: Array) -> tuple[Pose, float]:
        """Return the absolute target that an action asks for; the action counts from the measured pose."""
        measured, limits = self.tool_pose_in_base(arm), self.task.arm(arm).kind.limits
        step = np.clip(action, -1.0, 1.0)
        target = Pose(
            measured.position + step[:3] * limits.step_m,
            quaternion_multiply(quaternion_exp(step[3:6] * limits.step_rad), measured.quaternion_wxyz),
        )
        return target, float(0.5 * (step[6] + 1.0))


class _DrivenJoints:
    """Lead the joints of one arm in a world's data."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, arm: Arm) -> None:
        prefix, numbers = f"{arm.name}/joint", range(model.njnt)
        joints = [model.joint(i) for i in numbers if model.joint(i).name.startswith(prefix)]
        self._data = data
        self._qpos = np.array([int(joint.qposadr[0]) for joint in joints])
        self._dof = np.array([int(joint.dofadr[0]) for joint in joints])
        own = {joint.id for joint in joints}
        self._motors = [i for i in range(model.nu) if int(model.actuator_trnid[i, 0]) in own]
        names = (f"{arm.name}/left_finger", f"{arm.name}/right_finger")
        fingers = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in names]
        self._fingers = [int(model.jnt_qposadr[finger]) for finger in fingers if finger >= 0]
        servos = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name) for name in names]
        self._servos = [servo for servo in servos if servo >= 0]
        self._begin = self._end = self._data.qpos[self._qpos].copy()
        self._stroke_m = stroke_m(arm.kind.end_effector)
        self._gripper, self._closes = 0.0, False

    def rest(self, reading: ArmReading | None) -> None:
        """Stand where it was measured; without a reading, where it is."""
        if reading is not None:
            self._data.qpos[self._qpos] = reading.joint_positions
            self._data.qpos[self._fingers] = self._stroke_m * (1.0 - reading.gripper)
            self._gripper = reading.gripper
        self._data.qvel[self._dof] = 0.0
        self._data.ctrl[self._motors] = 0.0
        self._begin = self._end = self._data.qpos[self._qpos].copy()
        self._press()

    def begin(self, reading: ArmReading | None, *, closes: bool) -> None:
        """Begin a tick that ends at this reading. closes: the gripper is told to close."""
        self._begin = self._end
        if reading is not None:
            self._end, self._gripper = reading.joint_positions, reading.gripper
        if float(np.abs(self._end - self._begin).max()) > _LARGEST_MOVE_RAD:
            self._begin = self._end
        self._closes = closes
        self._press()

    def lead(self, share: float, period_s: float) -> None:
        """Put the joints to where they are at this share of the tick, as fast as they go; gravity is borne."""
        data = self._data
        data.qpos[self._qpos] = self._begin + share * (self._end - self._begin)
        data.qvel[self._dof] = (self._end - self._begin) / period_s
        data.qfrc_applied[self._dof] = data.qfrc_bias[self._dof] - data.qfrc_passive[self._dof]

    def _press(self) -> None:
        target_m = self._stroke_m * (1.0 - self._gripper) - (_SQUEEZE_M if self._closes else 0.0)
        self._data.ctrl[self._servos] = target_m
