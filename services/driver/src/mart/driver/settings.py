"""Define the settings of `mart driver`; each is an option and an environment variable."""

from __future__ import annotations

from pydantic import Field

from mart.driver.limits import MotionLimits
from mart.runtime.settings import Settings

_DEFAULTS = MotionLimits()


class DriverSettings(Settings):
    """Configure one driver of one arm."""

    room: str = Field("room-1", description="Id of the room.")
    arm: str = Field(description="Which of its arms.")
    driver: str = Field(description="Class that drives the hardware: module:Class or file.py:Class.")
    options: dict[str, str] = Field({}, description="What the class is constructed with.")
    tool_speed_m_s: float = Field(
        _DEFAULTS.tool_speed_m_s, gt=0.0, le=3.0, description="Of the tool, at most."
    )
    tool_speed_rad_s: float = Field(
        _DEFAULTS.tool_speed_rad_s, gt=0.0, le=10.0, description="Of the tool's turning, at most."
    )
    joint_speed_rad_s: float = Field(
        _DEFAULTS.joint_speed_rad_s, gt=0.0, le=10.0, description="Of each joint, at most."
    )
    load: float = Field(_DEFAULTS.load, gt=0.0, le=1.0, description="Share of the hardware's largest force.")

    @property
    def id(self) -> str:
        """Return the id of the service: there is one driver for an arm."""
        return f"{self.room}-{self.arm}"

    @property
    def limits(self) -> MotionLimits:
        """The limits within which the arm is led."""
        return MotionLimits(
            tool_speed_m_s=self.tool_speed_m_s,
            tool_speed_rad_s=self.tool_speed_rad_s,
            joint_speed_rad_s=self.joint_speed_rad_s,
            load=self.load,
        )
