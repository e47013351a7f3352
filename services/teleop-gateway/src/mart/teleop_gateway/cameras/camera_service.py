"""Serve `mart camera`: capture one camera of a room beside its hardware, for seats, files and the room's status."""

from __future__ import annotations

import contextlib
import logging
import math
import threading
from collections.abc import Callable
from typing import Any

from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.protocol import clock, codec, keys
from mart.protocol.cameras import camera_title
from mart.protocol.errors import Conflict
from mart.protocol.messages import CameraFrame, CameraReport, State
from mart.protocol.vocabulary import ServiceKind
from mart.render import Image
from mart.runtime.bus import Bus
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.runtime.service import Service, announced, connected
from mart.runtime.watchdog import end_process, start_vital_thread
from mart.teleop_gateway.cameras.camera_loop import CameraLoop
from mart.teleop_gateway.cameras.camera_pictures import CameraPictures
from mart.teleop_gateway.cameras.camera_settings import CameraSettings
from mart.teleop_gateway.cameras.camera_source import load_source
from mart.teleop_gateway.cameras.capture import Capture, OpenCvCapture
from mart.teleop_gateway.video.quality import QUALITIES, Quality
from mart.teleop_gateway.video.tick_times import TickTimes

_log = logging.getLogger(__name__)

_REPORT_EVERY_S = 0.25
_HANGS_AFTER_S = 20.0  # in one call of OpenCV; its own time limits are 3 and 5 s
_ENDS_WITHIN_S = 5.0


def serve_camera(settings: CameraSettings) -> None:
    """Capture until the process is asked to stop.

    Raises InvalidInput for a source that cannot be one, Conflict where another process captures this camera.
    """
    source = load_source(settings.source.get_secret_value())
    with (
        connected(settings, ServiceKind.CAMERA, settings.id) as service,
        contextlib.ExitStack() as opened,
    ):
        _require_alone(service)
        opened.enter_context(announced(service))
        _log.info("%s captures %s", camera_title(settings.camera), source.title)
        run_camera(service.bus, settings, OpenCvCapture(source), service.stop)


def _require_alone(service: Service) -> None:
    """Raise Conflict where another process captures this camera: pictures of both would take turns."""
    if service.bus.alive(keys.alive(service.kind, service.id)):
        raise Conflict(
            f"The camera {service.id} is captured by another process already; stop that one first."
        )


def run_camera(
    bus: Bus,
    settings: CameraSettings,
    capture: Capture,
    stop: threading.Event,
    end: Callable[[str], None] = end_process,
) -> None:
    """Capture until `stop` is set. A call of the camera that never returns ends the process: the next one tries."""
    publisher = CameraPublisher(bus, settings.room, settings.camera, QUALITIES[settings.quality])
    frozen_after_s = settings.frozen_after_s or math.inf
    with contextlib.closing(publisher):
        loop = CameraLoop(camera_title(settings.camera), capture, publisher.show, frozen_after_s)
        thread = start_vital_thread(lambda: loop.run(stop), f"camera-{settings.camera}", end)
        while not stop.wait(_REPORT_EVERY_S):
            now_s = clock.monotonic_s()
            publisher.report(loop, now_s)
            if now_s - loop.turned_s > _HANGS_AFTER_S:
                end(f"the camera {camera_title(settings.camera)} has not answered for {_HANGS_AFTER_S:g} s")
                return
        thread.join(_ENDS_WITHIN_S)


class CameraPublisher:
    """Publish one camera's pictures and how it does. Open from its making until `close`."""

    def __init__(self, bus: Bus, room: str, camera: str, quality: Quality) -> None:
        self._names: dict[str, Any] = {"room": room, "camera": camera}
        self._pictures = CameraPictures(quality)
        self._ticks = TickTimes()
        self._sequence = 0
        self._frames = bus.publisher(keys.camera_frame(room, camera))
        self._video = bus.publisher(keys.video(room, camera))
        self._reports = bus.publisher(keys.camera_report(room, camera))
        self._states = bus.subscribe(keys.state(room).key, DecodingSubscriber(State, self._on_state))

    def close(self) -> None:
        """Publish nothing any more."""
        self._states.close()
        for publisher in (self._frames, self._video, self._reports):
            publisher.close()

    def show(self, picture_bgr: Image, captured_s: float) -> None:
        """Publish a picture: to seats first, who wait for it, then for the file. On one thread."""
        captured_ns = clock.wall_ns() - round(1e9 * (clock.monotonic_s() - captured_s))
        jpeg = self._pictures.take(picture_bgr)
        self._sequence += 1
        frame = CameraFrame(
            **self._names,
            sequence=self._sequence,
            captured_ns=captured_ns,
            age_s=clock.monotonic_s() - captured_s,
            jpeg=jpeg,
        )
        self._frames.put(codec.encode(frame))
        encoded = self._pictures.encode(self._ticks.tick_at(captured_s), captured_s)
        video = CompressedVideo(frame_id=self._names["camera"], data=encoded.data, format="h264")
        video.timestamp.FromNanoseconds(captured_ns)
        self._video.put(codec.encode(video))

    def report(self, loop: CameraLoop, now_s: float) -> None:
        """Publish how the camera does."""
        darkness = loop.darkness(now_s)
        width_px, height_px = loop.size_px
        report = CameraReport(
            **self._names,
            dark=darkness.why if darkness else "",
            dark_s=now_s - darkness.since_s if darkness else 0.0,
            width_px=width_px,
            height_px=height_px,
            frames_per_s=loop.pictures_per_s(now_s),
        )
        self._reports.put(codec.encode(report))

    def _on_state(self, state: State) -> None:
        self._ticks.add(state.tick, state.boot, clock.monotonic_s())
