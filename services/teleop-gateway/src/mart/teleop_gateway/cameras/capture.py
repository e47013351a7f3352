"""Capture pictures with OpenCV: from a device (V4L2), a stream or a file (FFmpeg)."""

from __future__ import annotations

import os
from typing import Any, Protocol

import cv2

from mart.protocol import clock
from mart.render import Image
from mart.teleop_gateway.cameras.camera_source import CameraKind, CameraSource

_OPEN_TIMEOUT_MS = 5000
_READ_TIMEOUT_MS = 3000
_SLOWEST_HZ, _FASTEST_HZ, _FILE_HZ = 1.0, 60.0, 30.0
# A device's own V4L2 names for what is asked of it: Motion-JPEG carries 30 pictures a second over any USB.
_DEVICE = {
    cv2.CAP_PROP_FOURCC: cv2.VideoWriter.fourcc(*"MJPG"),
    cv2.CAP_PROP_FRAME_WIDTH: 640,
    cv2.CAP_PROP_FRAME_HEIGHT: 480,
    cv2.CAP_PROP_FPS: 30,
    cv2.CAP_PROP_BUFFERSIZE: 1,  # what waits in a buffer is old
}
_STREAM_OPTIONS = "rtsp_transport;tcp|fflags;nobuffer|flags;low_delay"


def keep_opencv_silent() -> None:
    """Let OpenCV and FFmpeg log nothing: they log whole addresses, passwords included.

    FFmpeg's level is read once, when OpenCV first uses it: call this before anything in the process does.
    """
    os.environ["OPENCV_FFMPEG_LOGLEVEL"] = "-8"
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)


class CameraFailure(Exception):
    """Tell why a camera gives no pictures, in a sentence without its address."""


class Capture(Protocol):
    """Give pictures, one after another. Any method may block for seconds and raise CameraFailure."""

    def open(self) -> None:
        """Get ready to read."""

    def read(self) -> Image:
        """Return the next picture, shape (rows, columns, 3), BGR, right after it was captured."""

    def close(self) -> None:
        """Give back what is held."""


class OpenCvCapture:
    """Capture one source. A file plays at its own rate and begins anew at its end."""

    def __init__(self, source: CameraSource) -> None:
        keep_opencv_silent()
        os.environ.setdefault("OPENCV_FFMPEG_CAPTURE_OPTIONS", _STREAM_OPTIONS)
        self._source = source
        self._capture: Any = None
        self._period_s = 0.0  # between two pictures of a file
        self._due_s = 0.0

    def open(self) -> None:
        """Open the source. Raises CameraFailure where that takes too long or fails."""
        self.close()
        self._capture = self._opened()
        if not self._capture.isOpened():
            self.close()
            raise CameraFailure("It cannot be opened")
        if self._source.kind is CameraKind.FILE:
            told_hz = float(self._capture.get(cv2.CAP_PROP_FPS))
            self._period_s = 1.0 / (told_hz if _SLOWEST_HZ <= told_hz <= _FASTEST_HZ else _FILE_HZ)
            self._due_s = clock.monotonic_s()

    def read(self) -> Image:
        """Return the next picture; of a file, when it is due. Raises CameraFailure where there is none."""
        self._wait()
        good, picture = self._capture.read()
        if not good and self._source.kind is CameraKind.FILE:
            self._capture.set(cv2.CAP_PROP_POS_FRAMES, 0)
            good, picture = self._capture.read()
        if not good or picture is None:
            raise CameraFailure("Its pictures ended")
        return picture

    def close(self) -> None:
        """Let go of the source."""
        if self._capture is not None:
            self._capture.release()
            self._capture = None

    def _opened(self) -> Any:
        if self._source.kind is CameraKind.DEVICE:
            capture = cv2.VideoCapture(self._source.device, cv2.CAP_V4L2)
            for name, value in _DEVICE.items():  # what it cannot do it does otherwise
                capture.set(name, value)
            return capture
        options = [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, _OPEN_TIMEOUT_MS]
        options += [cv2.CAP_PROP_READ_TIMEOUT_MSEC, _READ_TIMEOUT_MS]
        return cv2.VideoCapture(self._source.address, cv2.CAP_FFMPEG, options)

    def _wait(self) -> None:
        if self._period_s:
            now_s = clock.monotonic_s()
            self._due_s = max(self._due_s + self._period_s, now_s - self._period_s)
            clock.sleep_s(self._due_s - now_s)
