"""Keep how a room's cameras do, as they say it themselves. Pure; times are monotonic seconds.

Nothing waits for a camera: neither the barrier nor the pace knows of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from mart.protocol.cameras import camera_in_words
from mart.protocol.messages import CameraReport, Event, RoomCamera
from mart.sim.room import room_messages

SILENT_AFTER_S = 1.5  # a camera's process says how it does four times a second
_LONGEST_S = 1e9
_AT_ONCE_S = 1e-3
_ABSENT = "Nothing captures it."


class RoomCameras:
    """Hold the cameras that a room was opened with, by their ids; what any other says counts for nothing."""

    def __init__(self, names: Iterable[str] = (), now_s: float = 0.0) -> None:
        self.names = tuple(names)
        self._began_s = now_s
        self._heard: dict[str, tuple[CameraReport, float]] = {}
        self._told = dict.fromkeys(self.names, "")

    def hear(self, report: CameraReport, now_s: float) -> None:
        """Take what a camera says of itself."""
        if report.camera in self._told:
            self._heard[report.camera] = report, now_s

    def gone(self, camera: str, now_s: float) -> None:
        """Take that the process of a camera has ended: what it said last is old."""
        if camera in self._told:
            self._heard[camera] = CameraReport(), now_s - SILENT_AFTER_S - _AT_ONCE_S

    def news(self, now_s: float) -> list[Event]:
        """Return what to tell people: which cameras have gone dark or are back since this was asked last."""
        told: list[Event] = []
        for one in self.messages(now_s):
            name = camera_in_words(one.camera)
            sentence = f"{name[0].upper()}{name[1:]}"
            if one.dark and not self._told[one.camera]:
                told.append(room_messages.notice("warning", f"{sentence} gives no picture. {one.dark}"))
            elif self._told[one.camera] and not one.dark:
                told.append(room_messages.notice("info", f"{sentence} gives pictures again."))
            self._told[one.camera] = one.dark
        return told

    def messages(self, now_s: float) -> list[RoomCamera]:
        """Return how each camera does."""
        return [self._message(camera, now_s) for camera in self.names]

    def _message(self, camera: str, now_s: float) -> RoomCamera:
        report, heard_s = self._heard.get(camera, (None, self._began_s))
        silent_s = now_s - heard_s
        if report is None or silent_s > SILENT_AFTER_S:
            is_dark = silent_s > SILENT_AFTER_S
            return RoomCamera(
                camera=camera, dark=_ABSENT if is_dark else "", dark_s=silent_s if is_dark else 0.0
            )
        dark_s = report.dark_s if math.isfinite(report.dark_s) else 0.0
        return RoomCamera(
            camera=camera,
            dark=report.dark,
            dark_s=min(max(dark_s, 0.0), _LONGEST_S),
            width_px=report.width_px,
            height_px=report.height_px,
            frames_per_s=report.frames_per_s,
        )
