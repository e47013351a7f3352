"""Drive an arm for which LeRobot has a `Robot`, or somebody's plugin for LeRobot; LeRobot is imported when one is made.

    mart driver --room room-1 --arm arm0 --driver mart.driver.lerobot_arm:LeRobotArm \
        --option type=so101_follower --option port=/dev/ttyACM0 --option mapping=so101.toml

`docs/how-to-use-lerobot-robots.md` says how, and in which environment.
"""

from mart.driver.lerobot_arm.arm import LeRobotArm
from mart.driver.lerobot_arm.mapping import JointMapping

__all__ = ["JointMapping", "LeRobotArm"]
