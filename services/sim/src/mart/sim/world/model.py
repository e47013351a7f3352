"""Put room, arms and a task's things together and compile them."""

from __future__ import annotations

import math

import mujoco

from mart.protocol.arms.robot_file import Gains
from mart.protocol.control_rate import require_control_hz
from mart.sim.scene import arm_bodies, scenery
from mart.sim.scene.meshes import Detail
from mart.sim.scene.scene import Scene
from mart.sim.world import osc

_LARGEST_TIMESTEP_S = 0.002


def substeps(control_hz: float) -> tuple[int, float]:
    """Cut one control period: return the number of substeps and the seconds of each.

    The substep is 2 ms or the longest shorter one that divides the period: 20 Hz 25 x 2 ms, 30 Hz 17 x 1.961 ms,
    60 Hz 9 x 1.852 ms. Raises InvalidInput outside 5 to 100 Hz.
    """
    period_s = 1.0 / require_control_hz(control_hz)
    number = math.ceil(period_s / _LARGEST_TIMESTEP_S - 1e-9)
    return number, period_s / number


def build(
    scene: Scene, timestep_s: float, detail: Detail = "hull", gains: Gains | None = None
) -> mujoco.MjModel:
    """Compile a scene with its arms and their controller; `timestep_s`: of a substep."""
    spec = mujoco.MjSpec()
    spec.modelname = scene.task.name
    spec.compiler.degree = False
    scenery.configure(spec, timestep_s)
    scenery.add_room(spec, scene.task)
    arm_bodies.add_assets(spec, scene.task.arms, detail)
    for index, arm in enumerate(scene.task.arms):
        arm_bodies.add_arm(spec, arm, index, detail)
    scene.add_objects(spec)
    for camera in scene.cameras():
        scenery.add_camera(spec, camera)
    # The arms' blocks, what the scene remembers, and the count of successful ticks.
    spec.nuserdata = osc.BLOCK_SIZE * len(scene.task.arms) + scene.memory_size + 1
    osc.describe(spec, scene.task.arms, gains)
    return spec.compile()
