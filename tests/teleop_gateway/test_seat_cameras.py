"""A seat with real cameras shows what they capture: OpenCV reads a video file and a stream, aiortc sees it."""

from __future__ import annotations

import asyncio
import contextlib
import http.server
import threading
from collections.abc import Iterator
from pathlib import Path

import cv2
import pytest
from av import VideoFrame
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.protocol import codec, keys
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import CameraReport, SceneReply, SceneRequest, raise_error
from mart.protocol.tokens import Role
from mart.render import Image
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.teleop_gateway.cameras.camera_service import run_camera
from mart.teleop_gateway.cameras.camera_settings import CameraSettings
from mart.teleop_gateway.cameras.camera_source import load_source
from mart.teleop_gateway.cameras.capture import OpenCvCapture
from tests.support.message_collector import MessageCollector
from tests.teleop_gateway.browser import connected, in_background
from tests.teleop_gateway.cameras.fake_capture import plain, write_video
from tests.teleop_gateway.room import OnSeat, SeatUnderTest

GREEN, BLUE = (60, 180, 30), (30, 60, 190)  # RGB
GREEN_LIKE = pytest.approx(GREEN, abs=25)
BLUE_LIKE = pytest.approx(BLUE, abs=25)


def noisy(rgb: tuple[int, int, int], seed: int) -> Image:
    red, green, blue = rgb
    return plain((blue, green, red), 240, 320, noise=seed)


@pytest.fixture
def green_file(tmp_path: Path) -> str:
    """A second of video, which plays again and again."""
    return write_video(tmp_path / "table.avi", GREEN)


class BlueStream:
    """A network camera: Motion-JPEG over HTTP, as long as it is `on`."""

    def __init__(self) -> None:
        stream = self
        self.on = threading.Event()
        self.on.set()

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=picture")
                self.end_headers()
                stream._write(self)

            def log_message(self, *_: object) -> None: ...

        self._server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._ended = threading.Event()
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    @property
    def url(self) -> str:
        return f"http://ana:geheim@127.0.0.1:{self._server.server_port}/stream.mjpg"

    def _write(self, handler: http.server.BaseHTTPRequestHandler) -> None:
        seed = 0
        with contextlib.suppress(OSError):
            while self.on.is_set() and not self._ended.wait(0.04):
                seed += 1
                jpeg = cv2.imencode(".jpg", noisy(BLUE, seed))[1].tobytes()
                head = f"--picture\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n"
                handler.wfile.write(head.encode() + jpeg + b"\r\n")

    def close(self) -> None:
        self._ended.set()
        self._server.shutdown()
        self._server.server_close()


@pytest.fixture
def blue_stream() -> Iterator[BlueStream]:
    with contextlib.closing(BlueStream()) as stream:
        yield stream


@contextlib.contextmanager
def captured(router: str, room: str, camera: str, source: str) -> Iterator[None]:
    """What `mart camera` does, on a thread."""
    stop, settings = threading.Event(), CameraSettings(room=room, camera=camera, source=source)
    with ZenohBus.connect(router) as bus:
        capture = OpenCvCapture(load_source(source))
        thread = threading.Thread(target=run_camera, args=(bus, settings, capture, stop))
        thread.start()
        try:
            yield
        finally:
            stop.set()
            thread.join(20)


def middle(frame: VideoFrame) -> list[int]:
    """The colour at the picture's middle, RGB."""
    colour: list[int] = frame.to_ndarray(format="rgb24")[240, 320].tolist()
    return colour


@pytest.mark.timeout(120)
def test_a_seat_shows_its_camera_another_where_asked_and_says_when_it_goes_dark(
    on_seat: OnSeat, router: str, green_file: str, blue_stream: BlueStream, capfd: pytest.CaptureFixture[str]
) -> None:
    async def body(seat: SeatUnderTest) -> None:
        room = seat.room.name
        seat.room.film("arm0", "arm0-wrist")
        with (
            captured(router, room, "arm0", green_file),
            captured(router, room, "arm0-wrist", blue_stream.url),
            MessageCollector(seat.bus.bus, keys.video(room, "arm0").key, CompressedVideo) as green,
            MessageCollector(seat.bus.bus, keys.video(room, "arm0-wrist").key, CompressedVideo) as blue,
            MessageCollector(seat.bus.bus, keys.camera_report(room, "arm0-wrist").key, CameraReport) as said,
        ):
            async with connected(seat.exchange(Role.BROWSER)) as browser:
                async with asyncio.timeout(40):
                    while middle(await browser.next_frame()) != GREEN_LIKE:
                        pass
                    ticks = [tick for _ in range(20) if (tick := await browser.next_tick())]
                assert ticks == sorted(ticks)
                assert len(set(ticks)) > 5  # that each picture shows is written in it
                told = await browser.wait_told(lambda one: one.get("camera") == "arm0")
                assert told["tools"] == {}  # where it hangs is not known
                with pytest.raises(InvalidInput):
                    await scene(seat)
                browser.status.send('{"type":"drawing","on":true,"p50_ms":1,"p95_ms":1,"per_s":1}')
                browser.status.send('{"type":"camera","camera":"arm0-wrist"}')
                async with asyncio.timeout(40):
                    while middle(await browser.next_frame()) != BLUE_LIKE:
                        pass
                # Both are kept, whichever is shown.
                assert len(green) > 5
                assert len(blue) > 5
                await browser.drive(1, 0.3)
                async with in_background(browser.drive(1, clutch=True)):
                    await browser.wait_told(lambda one: one.get("engaged") is True)
                    blue_stream.on.clear()
                    await browser.wait_told(lambda one: one.get("let_go") == "picture")  # nobody drives blind
                told = await browser.wait_told(lambda one: one.get("no_picture", "") != "")
                assert told["no_picture"].startswith("The camera wrist of arm0:")
                async with asyncio.timeout(40):
                    while sum(middle(await browser.next_frame())) > 0.5 * sum(BLUE):
                        pass  # dark, with words in it
                await asyncio.to_thread(said.wait_for, lambda one: one.dark != "", 40.0)
                blue_stream.on.set()
                await browser.wait_told(lambda one: one.get("no_picture") == "", 40.0)
                async with asyncio.timeout(40):
                    while middle(await browser.next_frame()) != BLUE_LIKE:
                        pass

    on_seat(body)
    out, err = capfd.readouterr()
    assert "geheim" not in out + err


async def scene(seat: SeatUnderTest) -> None:
    request = codec.encode(SceneRequest())
    reply = codec.decode(SceneReply, await seat.bus.query(keys.scene(seat.room.name, "arm0"), request, 10.0))
    raise_error(reply.error)
