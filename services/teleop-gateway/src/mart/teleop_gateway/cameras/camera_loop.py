"""Capture one camera until told to stop: open it, read it, open it again where it fails. Reads may block."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable

from mart.protocol import clock
from mart.render import Image
from mart.teleop_gateway.cameras.capture import CameraFailure, Capture
from mart.teleop_gateway.cameras.picture_health import CameraDarkness, PictureHealth, wait_before_opening_s
from mart.teleop_gateway.video.captured_pictures import PICTURES_PER_S

_log = logging.getLogger(__name__)

_EARLY = 0.9  # of the time between two pictures: a camera's own clock differs a little


class CameraLoop:
    """Run a capture on a thread of its own, and tell how it does from any other.

    show: takes each picture that may be shown as new, and when it was captured (monotonic seconds), on that thread.
    """

    def __init__(
        self, title: str, capture: Capture, show: Callable[[Image, float], None], frozen_after_s: float
    ) -> None:
        self._title, self._capture, self._show = title, capture, show
        self._lock = threading.Lock()
        self._health = PictureHealth(clock.monotonic_s(), frozen_after_s)
        self._shown_s: list[float] = []
        self.size_px = (0, 0)  # width and height, as captured
        self.turned_s = clock.monotonic_s()  # when the thread last came back from the camera

    def run(self, stop: threading.Event) -> None:
        """Capture until `stop` is set."""
        failures = 0
        while not stop.wait(wait_before_opening_s(failures)):
            try:
                self._capture.open()
                with self._lock:
                    self._health.opened(clock.monotonic_s())
                _log.info("%s is open", self._title)
                while not stop.is_set():
                    self._take(self._capture.read())
                    failures = 0
            except CameraFailure as error:
                failures += 1
                self._fail(str(error), failures)
            except Exception as error:  # noqa: BLE001 - OpenCV raises what it likes; its text may hold the address
                failures += 1
                self._fail(f"It failed ({type(error).__name__})", failures)
            finally:
                self._capture.close()

    def darkness(self, now_s: float) -> CameraDarkness | None:
        """Return why there is no picture; None while all is well."""
        with self._lock:
            return self._health.darkness(now_s)

    def pictures_per_s(self, now_s: float) -> float:
        """Return how many pictures were shown in the last second."""
        with self._lock:
            return float(sum(now_s - shown_s <= 1.0 for shown_s in self._shown_s))

    def _take(self, picture_bgr: Image) -> None:
        now_s = clock.monotonic_s()
        with self._lock:
            self.turned_s = now_s
            self.size_px = picture_bgr.shape[1], picture_bgr.shape[0]
            is_new = self._health.see(picture_bgr, now_s)
            if self._shown_s and now_s - self._shown_s[-1] < _EARLY / PICTURES_PER_S:
                return
            if is_new:
                self._shown_s = [*self._shown_s[-int(PICTURES_PER_S) :], now_s]
        if is_new:
            self._show(picture_bgr, now_s)

    def _fail(self, why: str, failures: int) -> None:
        now_s = clock.monotonic_s()
        with self._lock:
            self.turned_s = now_s
            self._health.failed(why, now_s)
        if failures & (failures - 1) == 0:  # the first, second, fourth, … in a row
            _log.warning("%s: %s; it is tried again", self._title, why)
