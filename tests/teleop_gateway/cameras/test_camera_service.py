"""One camera's process, with a camera and a bus of memory: what goes out, and what happens when it goes dark."""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Iterator

import av
import numpy as np
import pytest
from av.video.codeccontext import VideoCodecContext
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.protocol import clock, codec, keys
from mart.protocol.messages import CameraFrame, CameraReport, State
from mart.runtime.bus.memory import MemoryNetwork
from mart.teleop_gateway.cameras import camera_service
from mart.teleop_gateway.cameras.camera_service import run_camera
from mart.teleop_gateway.cameras.camera_settings import CameraSettings
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.video.captured_pictures import decode_picture
from tests.support.message_collector import MessageCollector
from tests.teleop_gateway.cameras.fake_capture import FakeCapture, plain

ROOM, CAMERA = "room-1", "arm0-wrist"


class RunningCamera:
    """A camera's process on a thread, and what it says."""

    def __init__(self, network: MemoryNetwork, capture: FakeCapture) -> None:
        self.capture, self.ended = capture, queue.Queue[str]()
        self.bus = network.connect()
        self.frames = MessageCollector(self.bus, keys.camera_frame(ROOM, CAMERA).key, CameraFrame)
        self.reports = MessageCollector(self.bus, keys.camera_report(ROOM, CAMERA).key, CameraReport)
        self.video = MessageCollector(self.bus, keys.video(ROOM, CAMERA).key, CompressedVideo)
        settings = CameraSettings(room=ROOM, camera=CAMERA, source="0")
        self.stop = threading.Event()
        self.thread = threading.Thread(
            target=run_camera, args=(network.connect(), settings, capture, self.stop, self.ended.put)
        )
        self.thread.start()


@pytest.fixture
def camera() -> Iterator[RunningCamera]:
    capture = FakeCapture()
    running = RunningCamera(MemoryNetwork(), capture)
    yield running
    running.stop.set()
    capture.ended.set()
    running.thread.join(20)
    assert not running.thread.is_alive()


def test_a_picture_goes_whole_to_seats_and_with_its_tick_into_the_file(camera: RunningCamera) -> None:
    camera.reports.wait_next()  # it listens
    with contextlib.closing(camera.bus.publisher(keys.state(ROOM))) as states:
        states.put(codec.encode(State(room=ROOM, tick=41, boot=1)))
    before_ns = clock.wall_ns()
    camera.capture.script.put(plain((30, 180, 60), noise=1))
    frame = camera.frames.wait_for(lambda _: True)
    assert before_ns <= frame.captured_ns <= clock.wall_ns()
    assert (frame.room, frame.camera, frame.sequence) == (ROOM, CAMERA, 1)
    picture = decode_picture(frame.jpeg)
    assert picture.shape == (480, 640, 3)
    assert picture[240, 320].tolist() == pytest.approx((60, 180, 30), abs=8)  # RGB
    assert picture[:55].max() < 16  # 16 to 9 into 4 to 3: bars above and below
    video = camera.video.wait_for(lambda _: True)
    assert video.timestamp.ToNanoseconds() == frame.captured_ns
    decoder = VideoCodecContext.create("h264", "r")
    (kept,) = [*decoder.decode(av.Packet(video.data)), *decoder.decode(None)]
    assert tick_code.read(np.asarray(kept.to_ndarray(format="gray"), np.uint8)) == 41
    report = camera.reports.wait_for(lambda told: told.width_px == 160)
    assert (report.height_px, report.dark) == (90, "")


def test_one_that_fails_says_so_and_comes_back_by_itself(camera: RunningCamera) -> None:
    camera.capture.script.put(plain((30, 180, 60), noise=1))
    camera.frames.wait_for(lambda _: True)
    camera.capture.refusals.put("It cannot be opened")
    camera.capture.script.put("Its pictures ended")
    assert camera.reports.wait_for(lambda told: told.dark.startswith("Its pictures ended")).dark_s >= 0.0
    camera.reports.wait_for(lambda told: told.dark.startswith("It cannot be opened"))
    camera.capture.script.put(plain((30, 180, 60), noise=2))
    camera.frames.wait_for(lambda frame: frame.sequence == 2)
    camera.reports.wait_for(lambda told: told.dark == "")
    assert camera.capture.opened == camera.capture.closed + 1


def test_a_call_that_never_returns_is_told_and_ends_the_process(
    camera: RunningCamera, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(camera_service, "_HANGS_AFTER_S", 1.5)
    camera.reports.wait_for(lambda told: told.dark == "No picture comes from it.")
    assert "arm0.wrist has not answered" in camera.ended.get(timeout=20)
