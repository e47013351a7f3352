"""Read the messages of the app MuJoCo AR: a phone's pose by ARKit, and its two buttons. Pure.

The app connects to `ws://{host}:{port}` and sends a JSON text with every picture of its camera (up to 60 a second):
`rotation`, three lists of three numbers, each a *column* of the rotation matrix; `position`, three numbers, metres;
`button`, true while it is held; `toggle`, which changes with every tap. Axes: x ahead, y left, z up, of where the phone
looked when the app was started, along the floor. Source: `WebSocketManager.swift` and `ARKitManager.swift` of
github.com/omarrayyann/MujocoAR-iOS-App, and `connector.py` of the Python package mujoco_ar 1.4.0, which reads them.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput
from mart.protocol.pose import Pose, quaternion_from_matrix

LONGEST_MESSAGE_CHARS = 16_384  # with the hand's landmarks, which newer apps send too, it has some 3000
_FARTHEST_M = 100.0
_ROTATION_TOLERANCE = 0.01
# The session frame of a phone frame (x right, y up, z towards the person) seen from the app's axes.
_APP_TO_SESSION = np.array(((0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0)))


@dataclass(frozen=True)
class ARSample:
    """Hold where the phone is, in the session frame of a phone frame, and what is pressed."""

    pose_phone_in_session: Pose
    button: bool
    toggle: bool


def parse_sample(text: str | bytes) -> ARSample:
    """Return what a message of the app says. Raises InvalidInput where it is none, saying why."""
    if len(text) > LONGEST_MESSAGE_CHARS:
        raise InvalidInput(
            f"A message of {len(text)} characters came; at most {LONGEST_MESSAGE_CHARS} are read."
        )
    try:
        message = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InvalidInput("A message came that is not JSON; the app MuJoCo AR sends JSON texts.") from error
    if not isinstance(message, dict):
        raise InvalidInput("A message came that is no JSON object.")
    columns, position = _numbers(message, "rotation", (3, 3)), _numbers(message, "position", (3,))
    if np.abs(position).max() > _FARTHEST_M:
        raise InvalidInput(
            f"A position {np.abs(position).max():g} m away came; at most {_FARTHEST_M:g} are taken."
        )
    rotation = columns.T
    if np.abs(rotation @ columns - np.eye(3)).max() > _ROTATION_TOLERANCE or np.linalg.det(rotation) < 0:
        raise InvalidInput("A rotation came that is none: its columns must be orthogonal, of length 1.")
    in_session = _APP_TO_SESSION @ rotation @ _APP_TO_SESSION.T
    pose = Pose(_APP_TO_SESSION @ position, quaternion_from_matrix(in_session))
    return ARSample(pose, message.get("button") is True, message.get("toggle") is True)


def _numbers(message: dict[str, Any], name: str, shape: tuple[int, ...]) -> NDArray[np.float64]:
    try:
        numbers = np.array(message.get(name), np.float64)
    except (ValueError, TypeError, OverflowError):
        numbers = np.empty(0)
    if numbers.shape != shape or not np.isfinite(numbers).all():
        raise InvalidInput(f"A message without a good {name!r} came; {shape} finite numbers are needed.")
    return numbers
