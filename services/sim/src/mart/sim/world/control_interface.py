"""Do all that Python touches between two control periods: commands in; observations, memory and success out.

Written once for one world and for a batch; shapes (...) are () in a world and (worlds,) in a batch. Physics and
controller lie below, in MuJoCo and osc.c.
"""

from __future__ import annotations

import mujoco
import numpy as np

from mart.protocol.arms import ArmKind
from mart.protocol.tasks import gripper_observation
from mart.sim.scene.data import Array, Data
from mart.sim.scene.gripper import stroke_m
from mart.sim.scene.scene import Scene, TaskStatus
from mart.sim.scene.shadows import Shadows
from mart.sim.world import osc
from mart.sim.world.arm import MeasuredArms


class ControlInterface:
    """Command and observe one world or a batch; the scene must have been made for this data alone."""

    def __init__(self, scene: Scene, model: mujoco.MjModel, data: Data) -> None:
        scene.attach(data)
        self._scene = scene
        self._shadows = Shadows(model, data)
        self._arms = MeasuredArms(model, data, scene.task.arms)
        self._action_scale = np.array([_scale(arm.kind) for arm in scene.task.arms])
        blocks = data.userdata[..., : osc.BLOCK_SIZE * len(scene.task.arms)]
        blocks = blocks.reshape(*blocks.shape[:-1], len(scene.task.arms), osc.BLOCK_SIZE)
        self.modes, self.commands = blocks[..., osc.MODE], blocks[..., osc.COMMAND]
        self.postures = blocks[..., osc.POSTURE]
        self.success_ticks = data.userdata[..., -1]  # here, so that it is saved and replayed with the state

    def command(self, actions: Array) -> None:
        """Set what the arms do next; actions: shape (..., arms, 7), clipped to [-1, 1]."""
        np.multiply(np.minimum(np.maximum(actions, -1.0), 1.0), self._action_scale, out=self.commands)
        self.modes.fill(osc.NEW_DELTA)

    def settle(self) -> TaskStatus:
        """End a control period: remember what it did, judge it and count successful ticks; return the status."""
        self._scene.remember()
        status = self.task_status()
        np.multiply(self.success_ticks + 1.0, status.success_now, out=self.success_ticks)
        return status

    def task_status(self) -> TaskStatus:
        """Return subtasks, success and failure at this instant."""
        return self._scene.task_status()

    def cast_shadows(self) -> None:
        """Move the soft shadows under their casters."""
        self._shadows.follow()

    def observations(self) -> dict[str, Array]:
        """Return copies of all that any operator sees, in the catalogue's order, each (..., *its own)."""
        seen = self._scene.observe()
        positions, quaternions = self._arms.tools_in_base()
        grippers = self._arms.grippers()
        for index, name in enumerate(self._scene.task.arm_names):
            seen[f"{name}/tool_position_in_base"] = positions[..., index, :]
            seen[f"{name}/tool_quaternion_in_base"] = quaternions[..., index, :]
            seen[f"{name}/joint_positions"] = self._arms.joint_positions[index]
            seen[gripper_observation(name)] = grippers[..., index : index + 1]
        return {o.name: np.array(seen[o.name], dtype=np.float64) for o in self._scene.task.observations}


def _scale(kind: ArmKind) -> list[float]:
    """Return what each number of an action is multiplied by; the gripper's goes beyond the middle, so as to squeeze."""
    limits = kind.limits
    return [limits.step_m] * 3 + [limits.step_rad] * 3 + [-stroke_m(kind.end_effector)]
