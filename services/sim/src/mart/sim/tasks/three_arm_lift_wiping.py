"""Build lift and wipe: a tray of drinks stands on a dirty table; beside it a rack for the tray, and a sponge."""

from __future__ import annotations

import math

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.protocol.tasks.three_arm_lift_wiping import ASIDE_Y_M, RACK_TOP_M, SPOTS_M, WIPER, wipes_itself
from mart.protocol.tasks.tray import CARRIERS
from mart.sim.scene.data import Array, Data
from mart.sim.scene.gripper import GRASPABLE, WIPES
from mart.sim.scene.palette import rgba
from mart.sim.scene.scene import Scene, TaskStatus, any_of
from mart.sim.scene.shadows import add_shadow
from mart.sim.scene.symbols import add_tile
from mart.sim.scene.things import Thing
from mart.sim.tasks.dirt import Dirt, add_dirt
from mart.sim.tasks.tray import Tray, across, add_tray

_RACK_HALF_M = (0.13, 0.07, RACK_TOP_M[2] / 2)
LIFTED_M = 0.04  # of the tray's lowest corner: a tray that is dragged over the table stays under it
FALLEN_Z_M = -0.05

SPONGE_HALF_M = (
    0.045,
    0.030,
    0.015,
)  # about the sponge's origin; its length points away from the wiper's base
BLOCK_HALF_M, BLOCK_M = (0.030, 0.012, 0.020), (0.0, 0.0, 0.035)  # to hold it by

_TRAY_SPREAD_M, _TRAY_SPREAD_RAD = 0.04, 0.2
_SPONGE_IN_BASE = (0.38, 0.30)
_SPONGE_SPREAD_M, _SPONGE_SPREAD_RAD = 0.05, 0.5
_TOOL_Z_M = 0.22
# From where a carrier usually begins, in its base: to where its hand hides neither handle nor drinks from its camera.
_BEHIND_HANDLE_M = {"arm0": (-0.07, 0.18, 0.03), "arm1": (-0.07, -0.18, 0.03)}

_BOX = mujoco.mjtGeom.mjGEOM_BOX


class LiftWiping(Scene):
    """Define the scene of lift and wipe."""

    memory_size = len(SPOTS_M)

    def add_objects(self, spec: mujoco.MjSpec) -> None:
        add_tray(spec, [self.task.arm(name) for name in CARRIERS])
        if not wipes_itself(self.task):
            _add_sponge(spec, self.task.arm(WIPER))
        x, y, top = RACK_TOP_M
        spec.worldbody.add_geom(
            name="rack", type=_BOX, size=_RACK_HALF_M, pos=(x, y, top / 2), material="slate"
        )
        add_dirt(spec)

    def attach(self, data: Data) -> None:
        self._tray = Tray(data, [self.task.arm(name) for name in CARRIERS])
        self._sponge: Thing | None = None
        if wipes_itself(self.task):
            face = self.task.arm(WIPER).kind.end_effector.wiping
            assert face is not None
            pad = data.site(f"{WIPER}/tool")
            self._dirt = Dirt(data, self.memory(data), pad, (*face.half_m, face.below_tool_m))
        else:
            self._sponge = Thing(data, "sponge")
            self._dirt = Dirt(data, self.memory(data), data.body("sponge"), SPONGE_HALF_M)

    def place_objects(self, random: np.random.Generator) -> None:
        x, y = random.uniform(-_TRAY_SPREAD_M, _TRAY_SPREAD_M, 2)
        self._tray.place(x, y, random.uniform(-_TRAY_SPREAD_RAD, _TRAY_SPREAD_RAD), random)
        if self._sponge is not None:
            self._place(self._sponge, random)

    def _place(self, sponge: Thing, random: np.random.Generator) -> None:
        forward, left = _SPONGE_IN_BASE + random.uniform(-_SPONGE_SPREAD_M, _SPONGE_SPREAD_M, 2)
        yaw = random.uniform(-_SPONGE_SPREAD_RAD, _SPONGE_SPREAD_RAD)
        turn = np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)])
        sponge_in_base = Pose(np.array([forward, left, SPONGE_HALF_M[2]]), turn)
        placed = self.task.arm(WIPER).pose_base_in_world @ sponge_in_base
        sponge.put_at(placed)

    def start_pose_in_base(self, arm: Arm, random: np.random.Generator) -> Pose:
        start = super().start_pose_in_base(arm, random)
        if arm.name != WIPER:
            behind = start.position + _BEHIND_HANDLE_M[arm.name]
            return across(Pose(behind, start.quaternion_wxyz))
        over_sponge = np.array([*_SPONGE_IN_BASE, _TOOL_Z_M])
        return Pose(over_sponge + random.uniform(-0.03, 0.03, 3), start.quaternion_wxyz)

    def observe(self) -> dict[str, Array]:
        sponge = {} if self._sponge is None else self._sponge.observations()
        return {**self._tray.observe(), **sponge, "dirt/wiped": self._dirt.wiped}

    def remember(self) -> None:
        self._dirt.wipe()

    def task_status(self) -> TaskStatus:
        failed = self._tray.spills()
        if self._sponge is not None:
            failed["The sponge fell off the table."] = self._sponge.position[..., 2] < FALLEN_Z_M
        lifted = (self._tray.lowest_point_m() > LIFTED_M) & ~any_of(failed.values())
        aside = lifted & (self._tray.position[..., 1] < ASIDE_Y_M)
        clean = self._dirt.is_gone()
        return TaskStatus(
            {"lift_tray": lifted, "carry_tray": aside, "wipe_table": clean}, aside & clean, failed
        )


SCENE = LiftWiping


def _add_sponge(spec: mujoco.MjSpec, wiper: Arm) -> None:
    """Add a sponge under a block to hold it by."""
    sponge = spec.worldbody.add_body(name="sponge", pos=(0.3, 0.24, SPONGE_HALF_M[2]))
    sponge.add_freejoint(name="sponge")
    sponge.add_geom(
        name="sponge",
        type=_BOX,
        size=SPONGE_HALF_M,
        mass=0.05,
        material="sponge",
        **WIPES,
    )
    sponge.add_geom(
        name="sponge_block",
        type=_BOX,
        size=BLOCK_HALF_M,
        pos=BLOCK_M,
        mass=0.05,
        material="paint",
        rgba=rgba(wiper.color),
        **GRASPABLE,
    )
    top = (0.0, 0.0, BLOCK_M[2] + BLOCK_HALF_M[2])
    add_tile(spec, sponge, wiper.symbol, radius_m=0.010, position=top, normal=(0, 0, 1))
    add_shadow(spec, "sponge", radius_m=0.08)
