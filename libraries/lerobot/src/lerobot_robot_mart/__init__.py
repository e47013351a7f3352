"""Register MART with LeRobot: the robot `mart_seat`, a seat of a room, and the teleoperator `mart_arm`, an arm of one.

LeRobot finds this package by its name, and imports it; see docs/how-to-use-lerobot-robots.md.
"""

from lerobot_robot_mart.config_mart import MartArmConfig, MartSeatConfig
from lerobot_robot_mart.mart_arm import MartArm
from lerobot_robot_mart.mart_seat import MartSeat

__all__ = ["MartArm", "MartArmConfig", "MartSeat", "MartSeatConfig"]
