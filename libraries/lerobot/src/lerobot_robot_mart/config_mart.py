"""Define the configurations: each field is an option, `--robot.room=room-2` or `--teleop.arm=arm1`."""

from __future__ import annotations

from dataclasses import dataclass, field

from lerobot.robots import RobotConfig
from lerobot.teleoperators import TeleoperatorConfig


@RobotConfig.register_subclass("mart_seat")
@dataclass(kw_only=True)
class MartSeatConfig(RobotConfig):  # type: ignore[misc]  # LeRobot says no types
    """Choose a seat of a room.

    name: what people there see. kind: policy, or human where a person leads it. router: of the platform; None: as
    MART_ROUTER says, or this machine's. viewpoints: of the task, drawn width x height pixels.
    """

    room: str = "room-1"
    arm: str = "arm0"
    name: str = "lerobot"
    kind: str = "policy"
    router: str | None = None
    viewpoints: list[str] = field(default_factory=list)
    width: int = 320
    height: int = 240


@TeleoperatorConfig.register_subclass("mart_arm")
@dataclass(kw_only=True)
class MartArmConfig(TeleoperatorConfig):  # type: ignore[misc]  # LeRobot says no types
    """Choose an arm of a room, and how the robot that it leads calls its joints; see `LeaderNames`."""

    room: str = "room-1"
    arm: str = "arm0"
    router: str | None = None
    joints: list[str] = field(default_factory=list)
    zeros_deg: list[float] = field(default_factory=list)
    gripper: str = "gripper.pos"
