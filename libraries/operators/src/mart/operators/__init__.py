"""Drive seats of a room from a program: scripts, policies and operators of your own do it in the same way.

>>> from mart.operators import Operator, drive_seats
>>> class Riser(Operator):
...     def act(self, view):
...         return {arm: view.step(arm, (0, 0, 0.01)) for arm in view.poses_tool_in_base}
>>> drive_seats(Riser(), room="room-1", arms=["arm1"], episodes=1)  # doctest: +SKIP
"""

from mart.operators.client import drive_seats
from mart.operators.obedience import ObedientOperator
from mart.operators.operator import Operator, SeatView, ToolTarget, target_from_action
from mart.operators.room_client import RoomClient
from mart.protocol.vocabulary import OperatorKind

__all__ = [
    "ObedientOperator",
    "Operator",
    "OperatorKind",
    "RoomClient",
    "SeatView",
    "ToolTarget",
    "drive_seats",
    "target_from_action",
]
