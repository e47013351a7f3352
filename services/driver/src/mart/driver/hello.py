"""Ask a room for an arm: fetch its model, compare, and be welcome or be refused in a sentence."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import mujoco

from mart.driver.interface import Driver
from mart.driver.kinematics import ArmKinematics
from mart.protocol import codec, keys
from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import DriverHello, DriverReply, Model
from mart.protocol.tasks import Workspace, get_task
from mart.protocol.wire_version import DRIVER_WIRE_VERSION
from mart.runtime.ask import ask
from mart.runtime.bus import Bus

_TIMEOUT_S = 5.0
_FILE = "model.mjb"  # MuJoCo wants a name, also for what is in memory


@dataclass(frozen=True)
class Session:
    """Hold what was agreed with one run of a room."""

    number: int
    boot: int
    kinematics: ArmKinematics
    workspace: Workspace


def say_hello(bus: Bus, room: str, arm: str, driver: Driver, instance: str) -> Session:
    """Return a new session of this driver with the room.

    Raises InvalidInput where it is of another arm or version, NotFound where the room does not have that arm,
    Conflict where another driver has it, Unavailable where the room does not answer.
    """
    model = codec.decode(Model, bus.query(keys.model(room), b"", _TIMEOUT_S))
    kinematics = ArmKinematics(_compiled(model, room), arm)
    if kinematics.joint_count != driver.joint_count:
        raise InvalidInput(
            f"The driver {type(driver).__name__} has {driver.joint_count} joints; {arm} of {room} has "
            f"{kinematics.joint_count}."
        )
    hello = DriverHello(
        arm=arm,
        driver=type(driver).__name__,
        instance=instance,
        kind=driver.kind,
        joints=driver.joint_count,
        model_sha256=model.sha256,
        wire_version=DRIVER_WIRE_VERSION,
        servo_hz=driver.rate_hz,
    )
    reply = ask(bus, keys.driver(room), hello, DriverReply, _TIMEOUT_S)
    task = get_task(model.task, len(model.arms))
    return Session(reply.session, reply.boot, kinematics, task.workspace)


def _compiled(model: Model, room: str) -> mujoco.MjModel:
    if hashlib.sha256(model.mjb).hexdigest() != model.sha256:
        raise Corrupt(f"The model of {room} does not match its SHA-256: it was changed on its way.")
    if model.mujoco_version != mujoco.__version__:
        raise InvalidInput(
            f"The model of {room} is of MuJoCo {model.mujoco_version}; this driver has {mujoco.__version__}: install "
            "the same version of MART on both machines."
        )
    try:
        return mujoco.MjModel.from_binary_path(_FILE, {_FILE: model.mjb})
    except ValueError as error:
        raise Corrupt(f"The model of {room} cannot be loaded: {error}") from error
