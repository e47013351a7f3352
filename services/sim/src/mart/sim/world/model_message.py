"""Say what a world is compiled to, as the message that gateways, recorders and trainers read."""

from __future__ import annotations

import mujoco

from mart.protocol.messages import Model
from mart.sim.world.numerics import own_numerics
from mart.sim.world.world import World


def model_message(world: World) -> Model:
    """Return the compiled model of `world` (MJB bytes and their SHA-256) with task, control rate and arms."""
    return Model(
        sha256=world.model_sha256,
        mjb=world.model_bytes(),
        task=world.task.name,
        control_hz=world.control_hz,
        arms=world.arms,
        arm_kinds=world.task.arm_kinds,
        mujoco_version=mujoco.__version__,
        numerics=own_numerics(),
        task_file=b"" if world.task.file is None else world.task.file.text.encode(),
    )
