"""Make a seat of a room a robot of LeRobot's."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from lerobot.robots import Robot

from lerobot_robot_mart.config_mart import MartSeatConfig
from mart.lerobot_devices import ACTION_NAMES, SeatChoice, SeatSession


class MartSeat(Robot):  # type: ignore[misc]  # LeRobot says no types
    """Drive an arm of a room, beside people, scripts and policies, by MART's actions: 7 numbers in [-1, 1]."""

    config_class = MartSeatConfig
    name = "mart_seat"

    def __init__(self, config: MartSeatConfig) -> None:
        """Speak to nobody yet."""
        super().__init__(config)
        self.config = config
        self.cameras: dict[str, None] = dict.fromkeys(config.viewpoints)  # LeRobot counts them
        self._seat = SeatSession(
            SeatChoice(
                room=config.room,
                arm=config.arm,
                name=config.name,
                kind=config.kind,
                router=config.router,
                viewpoints=tuple(config.viewpoints),
                width_px=config.width,
                height_px=config.height,
            )
        )

    @cached_property
    def observation_features(self) -> dict[str, type | tuple[int, int, int]]:
        """The arm's observations, one float each, and the pictures; the room is asked for its task."""
        size = (self.config.height, self.config.width, 3)
        return {**dict.fromkeys(self._seat.observed_names(), float), **dict.fromkeys(self.cameras, size)}

    @property
    def action_features(self) -> dict[str, type]:
        """MART's action: the tool's way and turn as shares of a tick's limits, the gripper -1 open … 1 closed."""
        return dict.fromkeys(ACTION_NAMES, float)

    @property
    def is_connected(self) -> bool:
        """Whether the seat is held."""
        return self._seat.is_open

    @property
    def is_calibrated(self) -> bool:
        """Always: there is nothing to calibrate."""
        return True

    def connect(self, calibrate: bool = True) -> None:
        """Take the seat. Raises what says why not: Conflict where somebody sits there."""
        self._seat.open()

    def calibrate(self) -> None:
        """Nothing to calibrate."""

    def configure(self) -> None:
        """Nothing to configure."""

    def get_observation(self) -> dict[str, Any]:
        """Return floats, and pictures as uint8 arrays of shape (height, width, 3), all of one tick."""
        numbers, pictures = self._seat.observe()
        return {**numbers, **pictures}

    def send_action(self, action: dict[str, Any]) -> dict[str, float]:
        """Send an action, and return it as it was sent: each number within [-1, 1]."""
        return self._seat.send(action)

    def disconnect(self) -> None:
        """Leave the seat."""
        self._seat.close()
