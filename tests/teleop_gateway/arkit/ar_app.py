"""What the app MuJoCo AR sends, computed as its source does: ARKitManager.swift and WebSocketManager.swift."""

from __future__ import annotations

import json

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]

# The columns in ARKitManager.swift: from ARKit's axes (x right, y up, z to the back) to x ahead, y left, z up.
_AXES = np.array(((0, -1, 0, 0), (0, 0, 1, 0), (-1, 0, 0, 0), (0, 0, 0, 1)), np.float64).T


def camera_at(position: tuple[float, float, float], yaw_rad: float = 0.0, pitch_rad: float = 0.0) -> Matrix:
    """ARKit's `frame.camera.transform`: the camera in the world, 4 x 4."""
    cos_yaw, sin_yaw, cos_pitch, sin_pitch = (
        np.cos(yaw_rad),
        np.sin(yaw_rad),
        np.cos(pitch_rad),
        np.sin(pitch_rad),
    )
    yaw = np.array(((cos_yaw, 0, sin_yaw), (0, 1, 0), (-sin_yaw, 0, cos_yaw)))
    pitch = np.array(((1, 0, 0), (0, cos_pitch, -sin_pitch), (0, sin_pitch, cos_pitch)))
    transform = np.eye(4)
    transform[:3, :3] = yaw @ pitch
    transform[:3, 3] = position
    return transform


def app_message(
    camera: Matrix, *, began: Matrix | None = None, button: bool = False, toggle: bool = False
) -> str:
    """The text of a frame. began: `camera` as it was when the app was started."""
    began = camera_at((0, 0, 0)) if began is None else began
    calibrated = (_AXES @ camera) @ np.linalg.inv(_AXES @ began)
    columns = [calibrated[:3, column].tolist() for column in range(3)]
    return json.dumps(
        {
            "rotation": columns,
            "position": calibrated[:3, 3].tolist(),
            "toggle": toggle,
            "button": button,
        }
    )
