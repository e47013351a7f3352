"""Write a layout for Foxglove and Lichtblick that shows an episode at once: its world, its pictures, its actions."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import Conflict
from mart.protocol.recording import STATE
from mart.runtime.atomic_file import PUBLIC, write_atomically

_COLORS = ("#4e98e2", "#f5774d", "#f7df71", "#5cd6a9", "#a395e2", "#f25d9c", "#9aa0a6")
_ACTION = ("x", "y", "z", "turn x", "turn y", "turn z", "gripper")


def write_layout(episode: LabelledEpisode, path: Path) -> None:
    """Write the layout for episodes with these arms and cameras. Raises Conflict where something is there already."""
    if path.exists():
        raise Conflict(f"{path} is there already; name another file or remove it.")
    cameras = sorted(_cameras(episode))
    try:
        write_atomically(path, json.dumps(layout(episode.arms, cameras), indent=2).encode(), PUBLIC)
    except OSError as error:
        raise Conflict(f"{path} could not be written: {error}.") from error


def layout(arms: tuple[str, ...], cameras: list[str]) -> dict[str, Any]:
    """Return the layout: the world on the left, pictures above plots on the right. Pure."""
    panels: dict[str, Any] = {"3D!world": _world()}
    pictures = {f"Image!{camera}": _picture(camera) for camera in cameras}
    plots = {f"Plot!{arm}": _plot(arm) for arm in arms} or {"Plot!action": _plot(None)}
    right = [part for part in (_split(list(pictures), "row"), _split(list(plots), "column")) if part]
    return {
        "configById": panels | pictures | plots,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {
            "direction": "row",
            "first": "3D!world",
            "second": _split(right, "column"),
            "splitPercentage": 55,
        },
    }


def _split(parts: list[Any], direction: str) -> Any:
    """Return panels beside each other, each as wide as the others; None for none."""
    if not parts:
        return None
    if len(parts) == 1:
        return parts[0]
    return {
        "direction": direction,
        "first": parts[0],
        "second": _split(parts[1:], direction),
        "splitPercentage": 100 / len(parts),
    }


def _world() -> dict[str, Any]:
    return {
        "followTf": "world",
        "scene": {"transforms": {"visible": False}, "enableStats": False},
        "cameraState": {
            "perspective": True,
            "distance": 2.2,
            "phi": 60,
            "thetaOffset": 90,
            "targetOffset": [0, 0, 0.1],
            "target": [0, 0, 0],
            "targetOrientation": [0, 0, 0, 1],
            "fovy": 45,
            "near": 0.01,
            "far": 100,
        },
        "topics": {"/scene": {"visible": True}},
        "layers": {"grid": {"layerId": "foxglove.Grid", "visible": True, "size": 3, "divisions": 30}},
    }


def _picture(camera: str) -> dict[str, Any]:
    return {
        "imageMode": {
            "imageTopic": f"/view/{camera}/video",
            "calibrationTopic": f"/view/{camera}/calibration",
        },
        "foxglovePanelTitle": camera,
    }


def _plot(arm: str | None) -> dict[str, Any]:
    of = (
        f'{STATE}.arms[:]{{arm=="{arm}"}}.action'
        if arm
        else f'{STATE}.observations[:]{{name=="action"}}.value'
    )
    lines = [
        {
            "value": f"{of}[{i}]",
            "label": _ACTION[i] if arm else str(i),
            "enabled": True,
            "timestampMethod": "receiveTime",
            "color": _COLORS[i],
        }
        for i in range(ACTION_SIZE)
    ]
    return {
        "paths": lines,
        **({"minYValue": -1.1, "maxYValue": 1.1} if arm else {}),
        "showLegend": True,
        "legendDisplay": "floating",
        "xAxisVal": "timestamp",
        "isSynced": True,
        "foxglovePanelTitle": f"{arm}: action" if arm else "action",
    }


def _cameras(episode: LabelledEpisode) -> set[str]:
    """Return the cameras of which pictures were recorded."""
    found: set[str] = set()
    for message in episode.open().messages():
        parts = message.topic.split("/")
        if parts[-1] == "video":
            found.add(parts[-2])
    return found
