"""Cameras for tests: one of memory, which shows what is put before it and fails when told to, and video files."""

from __future__ import annotations

import queue
import threading
from pathlib import Path

import cv2
import numpy as np

from mart.render import Image
from mart.teleop_gateway.cameras.capture import CameraFailure, keep_opencv_silent


def plain(bgr: tuple[int, int, int], rows: int = 90, columns: int = 160, *, noise: int = 0) -> Image:
    """A picture of one colour; `noise` seeds what a sensor adds."""
    picture = np.full((rows, columns, 3), bgr, np.uint8)
    if noise:
        picture ^= np.random.default_rng(noise).integers(0, 4, picture.shape, dtype=np.uint8)
    return picture


def write_video(path: Path, rgb: tuple[int, int, int]) -> str:
    """Write a second of video of one colour with a sensor's noise; returns the path, which a camera takes."""
    keep_opencv_silent()
    red, green, blue = rgb
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 25.0, (320, 240))
    for seed in range(1, 26):
        writer.write(plain((blue, green, red), 240, 320, noise=seed))
    writer.release()
    return str(path)


class FakeCapture:
    """Gives the pictures and failures of `script`, and waits for more."""

    def __init__(self, *script: Image | str) -> None:
        self.script: queue.Queue[Image | str] = queue.Queue()
        for one in script:
            self.script.put(one)
        self.refusals: queue.Queue[str] = queue.Queue()
        self.opened, self.closed = 0, 0
        self.ended = threading.Event()

    def open(self) -> None:
        self.opened += 1
        if not self.refusals.empty():
            raise CameraFailure(self.refusals.get())

    def read(self) -> Image:
        while not self.ended.is_set():
            try:
                given = self.script.get(timeout=0.02)
            except queue.Empty:
                continue
            if isinstance(given, str):
                raise CameraFailure(given)
            return given
        raise CameraFailure("The test is over")

    def close(self) -> None:
        self.closed += 1
