"""Speak to a room as LeRobot's devices do, in turns of theirs: what `lerobot_robot_mart` is made of. No LeRobot here.

>>> with closing(SeatSession(SeatChoice(arm="arm1"))) as seat:  # doctest: +SKIP
...     seat.open()
...     seat.send({"x": 0.0, "y": 0.0, "z": 0.2, "turn_x": 0.0, "turn_y": 0.0, "turn_z": 0.0, "gripper": -1.0})
"""

from mart.lerobot_devices.features import ACTION_NAMES, LeaderNames
from mart.lerobot_devices.room_subscription import RoomSubscription
from mart.lerobot_devices.seat_session import SeatChoice, SeatSession

__all__ = ["ACTION_NAMES", "LeaderNames", "RoomSubscription", "SeatChoice", "SeatSession"]
