"""Sort what the command line gave: what is the driver's own, and what is the robot's configuration. Pure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from mart.driver.lerobot_arm.mapping import JointMapping, load_mapping
from mart.protocol.errors import InvalidInput

_INLINE = ("joints", "unit", "zeros", "gripper", "gripper_open", "gripper_closed")
_LARGEST_RATE_HZ = 1000.0


@dataclass(frozen=True)
class ArmOptions:
    """Hold the options of one arm. fields: of the robot's configuration in LeRobot, as they were written."""

    type: str
    kind: str
    mapping: JointMapping
    rate_hz: float
    fields: Mapping[str, str]


def arm_options(given: Mapping[str, str]) -> ArmOptions:
    """Return the options; raises InvalidInput, with what is allowed, for what is missing or wrong."""
    rest = dict(given)
    robot = rest.pop("type", "")
    if not robot:
        raise InvalidInput("Say which of LeRobot's robots it is: --option type=so101_follower.")
    rate_hz = _number("rate_hz", rest.pop("rate_hz", "50"))
    if not 10.0 <= rate_hz <= _LARGEST_RATE_HZ:
        raise InvalidInput(f"rate_hz={rate_hz:g} was given; 10 to 1000 are allowed.")
    kind = rest.pop("kind", robot)
    file = rest.pop("mapping", "")
    inline = {name: rest.pop(name) for name in _INLINE if name in rest}
    if bool(file) == ("joints" in inline) or (file and inline):
        raise InvalidInput(
            "Say which of the robot's values are the model's joints, in the model's order: either "
            "--option joints=shoulder_pan.pos,-shoulder_lift.pos,… (with unit, zeros, gripper, gripper_open, "
            f"gripper_closed), or --option mapping=FILE.toml. Given: {', '.join(inline) or file or 'nothing'}."
        )
    mapping = load_mapping(file) if file else JointMapping.of(_declared(inline), "The options")
    return ArmOptions(robot, kind, mapping, rate_hz, rest)


def _declared(inline: Mapping[str, str]) -> dict[str, Any]:
    """Return what the options declare, as a file would; a minus before a key turns its sign."""
    keys = [key.strip() for key in inline["joints"].split(",")]
    zeros = [_number("zeros", zero) for zero in inline.get("zeros", ",".join("0" for _ in keys)).split(",")]
    if len(zeros) != len(keys):
        raise InvalidInput(f"zeros has {len(zeros)} numbers for {len(keys)} joints; give one for each.")
    declared: dict[str, Any] = {
        "joint": [
            {
                "key": key.removeprefix("-"),
                "sign": -1 if key.startswith("-") else 1,
                "unit": inline.get("unit", "degrees"),
                "zero": zero,
            }
            for key, zero in zip(keys, zeros, strict=True)
        ]
    }
    ends = {name: inline[f"gripper_{name}"] for name in ("open", "closed") if f"gripper_{name}" in inline}
    if "gripper" in inline:
        declared["gripper"] = {"key": inline["gripper"], **ends}
    elif ends:
        raise InvalidInput("gripper_open and gripper_closed need gripper=KEY.")
    return declared


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise InvalidInput(f"{name}={text!r} was given; it is no number.") from error
