"""Make the scene of a task file: bodies of its MJCF, where it lets them begin, and its conditions."""

from __future__ import annotations

import math
from typing import cast

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm, Task
from mart.protocol.tasks.task_file import WORLD, SceneObject, Spawn, TaskFile
from mart.sim.scene.conditions import ConditionJudge, Judge
from mart.sim.scene.data import Array, Data, Flags
from mart.sim.scene.scene import Scene, TaskStatus, all_of
from mart.sim.scene.scene_bodies import add_scene_bodies, in_model
from mart.sim.scene.scenery import FixedCamera

_START_SPREAD_M = 0.03
_FALLEN_Z_M = -0.05
_SOON_S = 1e-9


class OwnScene(Scene):
    """Build what a task file says. In memory: for each subtask since when it holds, and whether it is done for good."""

    def __init__(self, task: Task) -> None:
        super().__init__(task)
        assert task.file is not None
        self._file: TaskFile = task.file
        lasting = any(one.for_s or one.stays for one in self._file.subtasks)
        self.memory_size = 2 * len(self._file.subtasks) if lasting else 0

    def add_objects(self, spec: mujoco.MjSpec) -> None:
        add_scene_bodies(spec, self._file)

    def attach(self, data: Data) -> None:
        file, self._data = self._file, data
        names = [one.name for one in file.objects]
        judge = ConditionJudge(data, names, self.task.arms, file.regions, in_model)
        self.things = judge.things
        self._subtasks = [judge.judge(one.when) for one in file.subtasks]
        self._success = judge.judge(file.success.when) if file.success.when is not None else None
        self._failures: dict[str, Judge] = {one.reason: judge.judge(one.when) for one in file.failures}
        memory = self.memory(data)
        fields = memory.reshape(*memory.shape[:-1], -1, 2)
        self._since_s, self._done = fields[..., 0], fields[..., 1]
        self._for_s = np.array([one.for_s for one in file.subtasks])
        self._stays = np.array([one.stays for one in file.subtasks])

    def place_objects(self, random: np.random.Generator) -> None:
        for one in self._file.objects:
            if one.spawn is not None:
                self._place(one, one.spawn, random)

    def observe(self) -> dict[str, Array]:
        seen = {}
        for name, thing in self.things.items():
            seen[f"{name}/position_in_world"] = thing.position
            seen[f"{name}/quaternion_in_world"] = thing.quaternion
        return seen

    def remember(self) -> None:
        if not self.memory_size:
            return
        holds, time_s = self._hold_now(), np.asarray(self._data.time)[..., None]
        since_s = np.where(self._since_s > 0.0, self._since_s, time_s)
        self._since_s[...] = np.where(holds, since_s, 0.0)
        lasted = holds & (time_s - self._since_s >= self._for_s - _SOON_S)
        self._done[...] = (self._done > 0.0) | (lasted & self._stays)

    def task_status(self) -> TaskStatus:
        done = self._hold_now()
        if self.memory_size:
            time_s = np.asarray(self._data.time)[..., None]
            lasted = (self._since_s > 0.0) & (time_s - self._since_s >= self._for_s - _SOON_S)
            done = (done & (lasted | (self._for_s == 0.0))) | (self._done > 0.0)
        subtasks = {one.name: done[..., index] for index, one in enumerate(self._file.subtasks)}
        success = all_of(subtasks.values()) if self._success is None else self._success()
        failed = {reason: judge() for reason, judge in self._failures.items()}
        return TaskStatus(subtasks, success, failed | self._fallen())

    def start_pose_in_base(self, arm: Arm, random: np.random.Generator) -> Pose:
        start_m = self._file.arms[self.task.arm_names.index(arm.name)].start_m
        spread = random.uniform(-_START_SPREAD_M, _START_SPREAD_M, 3)
        return Pose(np.array(start_m) + spread, Pose.identity().quaternion_wxyz)

    def cameras(self) -> tuple[FixedCamera, ...]:
        said = self._file.cameras
        return tuple(
            FixedCamera(one.name, (c := said[one.name]).position_m, c.target_m, c.fovy_deg)
            if one.name in said
            else one
            for one in super().cameras()
        )

    def _hold_now(self) -> Flags:
        return np.stack([np.asarray(judge()) for judge in self._subtasks], axis=-1)

    def _fallen(self) -> dict[str, Flags]:
        if not self._file.scene.furniture:
            return {}
        return {
            f"The {name} fell off the table.": thing.position[..., 2] < _FALLEN_Z_M
            for name, thing in self.things.items()
        }

    def _place(self, one: SceneObject, spawn: Spawn, random: np.random.Generator) -> None:
        """Put an object of a single world where an episode begins, as it lies in the MJCF but for its yaw."""
        data, name = cast("mujoco.MjData", self._data), in_model(one.name)
        model, body = data.model, data.model.body(name)
        x, y = random.uniform(*spawn.x_m), random.uniform(*spawn.y_m)
        yaw_rad = random.uniform(*spawn.yaw_rad)
        base = Pose.identity() if spawn.frame == WORLD else self.task.arm(spawn.frame).pose_base_in_world
        own = Pose(np.zeros(3), np.array(body.quat, dtype=np.float64))
        turn = Pose(np.array([x, y, 0.0]), np.array([math.cos(yaw_rad / 2), 0.0, 0.0, math.sin(yaw_rad / 2)]))
        pose = base @ turn @ own
        z = float(body.pos[2]) if spawn.z_m is None else base.position[2] + spawn.z_m
        position = (*pose.position[:2], z)
        mocap = int(model.body_mocapid[body.id])
        if mocap >= 0:
            data.mocap_pos[mocap], data.mocap_quat[mocap] = position, pose.quaternion_wxyz
        else:
            data.joint(name).qpos[:] = (*position, *pose.quaternion_wxyz)
