"""Make an arm of a room a teleoperator of LeRobot's: whoever drives it leads a robot."""

from __future__ import annotations

from typing import Any

from lerobot.teleoperators import Teleoperator

from lerobot_robot_mart.config_mart import MartArmConfig
from mart.lerobot_devices import LeaderNames, RoomSubscription


class MartArm(Teleoperator):  # type: ignore[misc]  # LeRobot says no types
    """Tell where an arm's joints are, in degrees, and its gripper, 0 closed … 100 open. It only listens."""

    config_class = MartArmConfig
    name = "mart_arm"

    def __init__(self, config: MartArmConfig) -> None:
        """Speak to nobody yet."""
        super().__init__(config)
        self.config = config
        self._names = LeaderNames(config.joints, config.zeros_deg, config.gripper)
        self._feed: RoomSubscription | None = None
        self._connected = False

    @property
    def action_features(self) -> dict[str, type]:
        """One float a joint, and the gripper; the room is asked how many joints the arm has."""
        return dict.fromkeys(self.get_action(), float)

    @property
    def feedback_features(self) -> dict[str, type]:
        """Nothing is felt."""
        return {}

    @property
    def is_connected(self) -> bool:
        """Whether the room is listened to."""
        return self._connected

    @property
    def is_calibrated(self) -> bool:
        """Always: there is nothing to calibrate."""
        return True

    def connect(self, calibrate: bool = True) -> None:
        """Listen to the room; raises what says why it cannot be, and where the names do not fit the arm."""
        self.get_action()
        self._connected = True

    def calibrate(self) -> None:
        """Nothing to calibrate."""

    def configure(self) -> None:
        """Nothing to configure."""

    def get_action(self) -> dict[str, float]:
        """Return where the arm was in the room's newest tick."""
        feed = self._room()
        state = feed.state()
        joints = feed.observation(state, f"{feed.arm}/joint_positions")
        self._names.names(len(joints))
        return self._names.action(joints, feed.arm_state(state).gripper)

    def send_feedback(self, feedback: dict[str, Any]) -> None:
        """Take feedback, which nobody can feel here."""

    def disconnect(self) -> None:
        """Listen no more."""
        self._connected = False
        if self._feed is not None:
            self._feed.close()
            self._feed = None

    def _room(self) -> RoomSubscription:
        if self._feed is None:
            self._feed = RoomSubscription(self.config.room, self.config.arm, self.config.router)
        return self._feed
