"""Step one world: a task's scene, its arms and their controller, one control period at a time.

Pure: no wall clock, no threads, no bus; randomness comes from the seed given to `reset`. Everything that decides the
future is in the integration state (positions, velocities, warm start, commands, what the scene remembers, the count of
successful ticks), so setting a state and stepping the same actions gives the same bits as the first time.
"""

from __future__ import annotations

import copy
import hashlib
import logging
import math
from functools import cached_property

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.control_rate import DEFAULT_CONTROL_HZ
from mart.protocol.errors import InvalidInput
from mart.protocol.pose import Pose, quaternion_conjugate, quaternion_log, quaternion_multiply
from mart.protocol.tasks import Task, get_task
from mart.sim.scene import panda
from mart.sim.scene.data import Array
from mart.sim.scene.meshes import Detail
from mart.sim.scene.scene import Scene, TaskStatus
from mart.sim.tasks import scene_of
from mart.sim.world import kinematics, model, osc
from mart.sim.world.arm import MeasuredArm
from mart.sim.world.control_interface import ControlInterface
from mart.sim.world.last_states import Diverged, LastStates, StateHistory
from mart.sim.world.progress import Score, TaskProgress, first_reasons

# As a number: looking an enumeration up takes longer than what is called with it.
STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION)
FATAL_WARNINGS = slice(int(mujoco.mjtWarning.mjWARN_BADQPOS), int(mujoco.mjtWarning.mjWARN_BADQACC) + 1)

_HOLD_OPEN = np.array([0.0] * 6 + [-1.0])


def _log_warning(message: str) -> None:
    """Log a warning of MuJoCo, whose own habit is to write MUJOCO_LOG.TXT to wherever the process runs."""
    logging.getLogger(__name__).warning("MuJoCo: %s", message)


class World:
    """Hold a compiled task and its state. Build with `World.build`, then `reset` before anything else.

    Actions: shape (arms, 7), each number in [-1, 1] (clipped): translation along the arm's base axes over
    `task.limits.step_m`, rotation vector about them over `task.limits.step_rad`, gripper -1 open … +1 closed. They
    count from the tool's measured pose.
    """

    def __init__(
        self, scene: Scene, control_hz: float, detail: Detail = "hull", compiled: mujoco.MjModel | None = None
    ) -> None:
        osc.install()
        mujoco.set_mju_user_warning(_log_warning)
        self._scene = scene
        self.substeps, timestep_s = model.substeps(control_hz)
        self.control_hz, self.control_period_s = control_hz, 1.0 / control_hz
        self.success_hold_ticks = scene.task.success_hold_at(control_hz)
        self.model = compiled or model.build(scene, timestep_s, detail)
        self.model.opt.timestep = timestep_s
        self.data = mujoco.MjData(self.model)
        self._interface = ControlInterface(scene, self.model, self.data)
        self._measured = {arm: MeasuredArm(self.model, self.data, arm) for arm in self.arms}
        self._action_shape = (len(self.arms), ACTION_SIZE)
        self._history = StateHistory(self.model, self._action_shape)
        self._fatal_warnings = self.data.warning.number[FATAL_WARNINGS]

    @classmethod
    def build(
        cls,
        task_name: str,
        control_hz: float = DEFAULT_CONTROL_HZ,
        arms: int | None = None,
        detail: Detail = "hull",
    ) -> World:
        """Compile a task by name; raises NotFound for an unknown one, InvalidInput for an impossible rate or arms."""
        return cls(scene_of(get_task(task_name, arms)), control_hz, detail)

    def at(self, control_hz: float) -> World:
        """Return the same world in ticks of another rate, not reset yet; raises InvalidInput for an impossible one.

        What it compiles to differs in the timestep alone, so nothing is compiled: it takes milliseconds.
        """
        return World(type(self._scene)(self.task), control_hz, compiled=copy.copy(self.model))

    @property
    def task(self) -> Task:
        """The catalogue's row of the task."""
        return self._scene.task

    @property
    def arms(self) -> tuple[str, ...]:
        """The arms' names, in order."""
        return self.task.arm_names

    @property
    def sim_time_s(self) -> float:
        """Simulated seconds since the reset."""
        return float(self.data.time)

    @cached_property
    def _mjb(self) -> bytes:
        buffer = np.empty(mujoco.mj_sizeModel(self.model), np.uint8)
        mujoco.mj_saveModel(self.model, None, buffer)
        return buffer.tobytes()

    def model_bytes(self) -> bytes:
        """Return the compiled model (MJB), as it goes over the wire and into episode files."""
        return self._mjb

    @cached_property
    def model_sha256(self) -> str:
        """The compiled model's SHA-256 in hex: what tells versions of a world apart."""
        return hashlib.sha256(self._mjb).hexdigest()

    def reset(self, seed: int) -> None:
        """Begin an episode: things and arms where this seed puts them, arms at rest and holding."""
        random = np.random.default_rng(seed)
        mujoco.mj_resetData(self.model, self.data)
        self._history.clear()
        self._scene.place_objects(random)
        for index, arm in enumerate(self.task.arms):
            tool_in_world = arm.pose_base_in_world @ self._scene.start_pose_in_base(arm, random)
            joints = kinematics.solve(self.model, arm.name, tool_in_world, np.array(panda.HOME_RAD))
            self._measured[arm.name].place(joints)
            self._interface.postures[index] = joints
        self._interface.command(np.tile(_HOLD_OPEN, (len(self.arms), 1)))
        mujoco.mj_forward(self.model, self.data)

    def tool_pose_in_base(self, arm: str) -> Pose:
        """Return the measured pose of the arm's tool in its base frame."""
        return Pose(*self._arm(arm).tool_in_base())

    def gripper(self, arm: str) -> float:
        """Return how far the gripper is measured to be closed, 0 open … 1 closed."""
        return self._arm(arm).gripper()

    def action_for(self, arm: str, target_tool_in_base: Pose, gripper: float) -> Array:
        """Return the action, shape (7,), that goes towards an absolute target as far as workspace and limits allow.

        gripper: 0 open … 1 closed. To hold an arm, keep asking with one fixed target: taking the measured pose as the
        target every tick lets a loaded arm sink.
        """
        position, quaternion = self._arm(arm).tool_in_base()
        target = self.task.workspace.clamp(target_tool_in_base)
        shift = target.position - position
        turn = quaternion_multiply(target.quaternion_wxyz, quaternion_conjugate(quaternion))
        return np.concatenate(
            [
                _within_unit(shift / self.task.limits.step_m),
                _within_unit(quaternion_log(turn) / self.task.limits.step_rad),
                [2.0 * min(max(gripper, 0.0), 1.0) - 1.0],
            ]
        )

    def step(self, actions: ArrayLike) -> TaskStatus:
        """Advance one control period; return how the task stands then.

        Raises InvalidInput where the shape is not (arms, 7) or a number is not finite, Diverged where the physics left
        its bounds.
        """
        self.drive(actions)
        return self._interface.settle()

    def drive(self, actions: ArrayLike) -> None:
        """Do the part of a step that moves the arms, physics and control; nothing is remembered or judged."""
        actions = np.asarray(actions, dtype=np.float64)
        if actions.shape != self._action_shape:
            raise InvalidInput(
                f"Actions of shape {actions.shape} were given; {self._action_shape} is needed."
            )
        if not math.isfinite(sum(actions.ravel().tolist())):
            raise InvalidInput("Actions with NaN or infinity were given; every number must be finite.")
        begun_s = self.sim_time_s
        self._history.note(self.data, actions)
        self._interface.command(actions)
        self._advance(actions)
        # Poses of the new state: mj_step leaves those of its last substep's beginning.
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_checkVel(self.model, self.data)  # what MuJoCo would find bad next time is told this time
        if any(self._fatal_warnings.tolist()):
            raise Diverged(begun_s, self.last_states(*self._history.states_and_actions()))

    def _advance(self, _actions: Array) -> None:
        """Step the physics for one control period; the arms have been commanded."""
        mujoco.mj_step(self.model, self.data, self.substeps)

    def last_states(self, states: Array, actions: Array) -> LastStates:
        """Describe states of this model, shape (n, size), and actions in them, shape (n, arms, 7)."""
        return LastStates(self.task.name, self.control_hz, self.model_sha256, states, actions)

    def integration_state(self) -> bytes:
        """Return MuJoCo's full integration state, float64 little-endian: what decides the future, and shadows."""
        self._interface.cast_shadows()
        state = np.empty(mujoco.mj_stateSize(self.model, STATE))
        mujoco.mj_getState(self.model, self.data, state, STATE)
        return state.astype("<f8", copy=False).tobytes()

    def set_integration_state(self, state: bytes) -> None:
        """Set the whole state; raises InvalidInput where its size is not this model's or a number is not finite."""
        expected = 8 * mujoco.mj_stateSize(self.model, STATE)
        if len(state) != expected:
            raise InvalidInput(f"A state of {len(state)} bytes was given; this model's has {expected}.")
        numbers = np.frombuffer(state, dtype="<f8").astype(np.float64)
        if not np.isfinite(numbers).all():
            raise InvalidInput("A state with NaN or infinity was given; every number must be finite.")
        mujoco.mj_resetData(self.model, self.data)
        self._history.clear()
        mujoco.mj_setState(self.model, self.data, numbers, STATE)
        mujoco.mj_kinematics(self.model, self.data)

    def observations(self) -> dict[str, Array]:
        """Return all that any operator sees, in the catalogue's order."""
        return self._interface.observations()

    def observations_for(self, arm: str) -> dict[str, Array]:
        """Return what this arm's operator sees."""
        seen = self.observations()
        return {observation.name: seen[observation.name] for observation in self.task.observations_of(arm)}

    def progress(self, status: TaskStatus | None = None) -> TaskProgress:
        """Return how far the task is; status: what `step` returned, if nothing changed since; else judged now."""
        status = status or self._interface.task_status()
        ticks = int(self._interface.success_ticks)
        (reason,) = first_reasons(status.failed, worlds=1)
        return TaskProgress(
            subtasks={name: bool(done) for name, done in status.subtasks.items()},
            success_now=bool(status.success_now),
            success_ticks=ticks,
            success=ticks >= self.success_hold_ticks,
            failed=reason or None,
            scores={
                name: Score(float(score.seconds), int(score.tries)) for name, score in status.scores.items()
            },
        )

    def to_do(self, arm: str, progress: TaskProgress | None = None) -> str:
        """Return in a line what this arm's operator is to do now; progress: where it is known, else judged now."""
        subtasks = (progress or self.progress()).subtasks
        return self._scene.to_do(arm, {name for name, done in subtasks.items() if done})

    def _arm(self, name: str) -> MeasuredArm:
        return self._measured[self.task.arm(name).name]


def _within_unit(vector: Array) -> Array:
    """Return the vector, shortened to length 1 where it is longer."""
    return vector / max(1.0, float(np.linalg.norm(vector)))
