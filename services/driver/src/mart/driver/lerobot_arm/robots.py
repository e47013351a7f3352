"""Find LeRobot's robots by LeRobot's own names, and make one. LeRobot is imported here, when it is asked for."""

from __future__ import annotations

import dataclasses
import importlib
import logging
import pkgutil
from collections.abc import Collection, Mapping
from typing import Any

from mart.driver.lerobot_arm.robot_thread import LeRobotRobot
from mart.protocol.errors import InvalidInput, NotFound

_log = logging.getLogger(__name__)

# What a driver says of its own accord where the configuration has it and nobody said otherwise: at the end of a driver
# the arm must hold still, and LeRobot's default lets it drop.
_HOLDS_AT_THE_END = "disable_torque_on_disconnect"


def make_robot(robot_type: str, fields: Mapping[str, str]) -> LeRobotRobot:
    """Return a robot of LeRobot's, not connected, with `fields` of its configuration as they were written.

    Raises InvalidInput where LeRobot is not there or a field is wrong, NotFound for an unknown type; in a sentence that
    says what there is.
    """
    config = _config(robot_type, fields)
    try:
        return _lerobot("lerobot.robots").make_robot_from_config(config)
    except Exception as error:
        raise InvalidInput(f"LeRobot cannot make a {robot_type}: {_said(error)}.") from error


def float_features(features: Mapping[str, object]) -> Collection[str]:
    """Return the names of the numbers among a robot's features; pictures are none."""
    return [name for name, kind in features.items() if kind is float]


def counts_in_degrees(robot: LeRobotRobot) -> bool | None:
    """Whether a robot of LeRobot's counts its joints in degrees, else in percent; None: it does not say."""
    said = getattr(getattr(robot, "config", None), "use_degrees", None)
    return said if isinstance(said, bool) else None


def _config(robot_type: str, fields: Mapping[str, str]) -> object:
    unusable = _import_all()
    base = _lerobot("lerobot.robots").RobotConfig
    known = base.get_known_choices()
    if robot_type not in known:
        error = NotFound.named("robot of LeRobot's", robot_type, known)
        why = f" Not usable here: {'; '.join(unusable)}." if unusable else ""
        raise NotFound(f"{error}{why}")
    allowed = {field.name: field for field in dataclasses.fields(known[robot_type]) if field.init}
    unknown = [name for name in fields if name not in allowed]
    if unknown:
        raise InvalidInput(f"{robot_type} has no option {', '.join(unknown)}; it has {', '.join(allowed)}.")
    yaml = importlib.import_module("yaml")
    values: dict[str, Any] = {_HOLDS_AT_THE_END: False} if _HOLDS_AT_THE_END in allowed else {}
    for name, text in fields.items():
        is_text = str(allowed[name].type) in ("<class 'str'>", "str", "str | None")
        try:
            values[name] = text if is_text else yaml.safe_load(text)
        except yaml.YAMLError as error:
            raise InvalidInput(f"{name}={text!r} was given to {robot_type}; it is no YAML.") from error
    try:
        return importlib.import_module("draccus").decode(known[robot_type], values)
    except Exception as error:
        needed = [name for name, field in allowed.items() if _is_needed(field) and name not in values]
        missing = f" It needs {', '.join(needed)}." if needed else ""
        raise InvalidInput(f"{robot_type} cannot have {dict(fields)}: {_said(error)}.{missing}") from error


def _import_all() -> list[str]:
    """Import LeRobot's robots and everybody's plugins, so that their types are known; returns which could not be."""
    robots = _lerobot("lerobot.robots")
    _lerobot("lerobot.utils.import_utils").register_third_party_plugins()
    unusable = []
    for module in pkgutil.iter_modules(robots.__path__):
        if module.ispkg:
            try:
                importlib.import_module(f"lerobot.robots.{module.name}")
            except Exception as error:  # noqa: BLE001 - one that lacks its hardware's library; the others are there
                unusable.append(f"{module.name} ({_said(error)})")
    return unusable


def _lerobot(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise InvalidInput(
            f"LeRobot cannot be imported here ({error}): run `mart driver` in the environment in which LeRobot is "
            "installed; see docs/how-to-use-lerobot-robots.md."
        ) from error


def _is_needed(field: dataclasses.Field[Any]) -> bool:
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def _said(error: Exception) -> str:
    return next(iter(str(error).strip().splitlines()), type(error).__name__).rstrip(".")
