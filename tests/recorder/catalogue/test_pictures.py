"""With real pictures: what was encoded comes out as a video that plays at the recorded times, and as a still."""

from __future__ import annotations

import io

import av
import numpy as np
import pytest

from mart.protocol.errors import Corrupt
from mart.recorder.catalogue.pictures import RecordedFrame, last_picture, write_mp4

EVERY_NS = 50_000_000
STRIP_ROWS = 16


@pytest.fixture(scope="module")
def frames() -> list[RecordedFrame]:
    return pictures(640, 496)


def pictures(width_px: int, height_px: int) -> list[RecordedFrame]:
    """25 pictures in Annex B, a key frame every 10, each brighter than the one before, with a white strip below."""
    encoder = av.CodecContext.create("libx264", "w")
    assert isinstance(encoder, av.VideoCodecContext)
    encoder.width, encoder.height, encoder.pix_fmt = width_px, height_px, "yuv420p"
    encoder.options = {"tune": "zerolatency", "x264-params": "keyint=10:scenecut=0:repeat-headers=1:annexb=1"}
    packets = []
    for number in range(25):
        image = np.full((height_px, width_px, 3), 4 * number, np.uint8)
        image[-STRIP_ROWS:] = 255
        picture = av.VideoFrame.from_ndarray(image, format="rgb24")
        picture.pts = number
        packets += encoder.encode(picture)
    return [RecordedFrame(number * EVERY_NS, bytes(packet)) for number, packet in enumerate(packets)]


def as_mp4(frames: list[RecordedFrame]) -> bytes:
    out = io.BytesIO()
    write_mp4(frames, out)
    return out.getvalue()


def test_key_frames_are_known(frames: list[RecordedFrame]) -> None:
    assert [number for number, frame in enumerate(frames) if frame.is_key] == [0, 10, 20]


def test_a_video_plays_every_picture_at_its_time(frames: list[RecordedFrame]) -> None:
    late = [
        RecordedFrame(frame.image_ns + (number > 12) * 10 * EVERY_NS, frame.data)
        for number, frame in enumerate(frames)
    ]
    with av.open(io.BytesIO(as_mp4(late)), "r") as video:
        played = [
            (picture.time, picture.to_ndarray(format="gray")[100, 100]) for picture in video.decode(video=0)
        ]
    assert [at_s for at_s, _ in played] == pytest.approx([frame.image_ns / 1e9 for frame in late], abs=1e-4)
    assert np.all(np.diff([int(grey) for _, grey in played]) > 0)


def test_a_video_plays_pictures_that_became_smaller(frames: list[RecordedFrame]) -> None:
    """As those of a seat do that would have come late."""
    smaller = [RecordedFrame(frame.image_ns + 25 * EVERY_NS, frame.data) for frame in pictures(320, 248)]
    with av.open(io.BytesIO(as_mp4([*frames, *smaller])), "r") as video:
        widths = [picture.width for picture in video.decode(video=0)]
    assert widths == [640] * 25 + [320] * 25


def test_a_still_is_small_and_without_the_ticks_code(frames: list[RecordedFrame]) -> None:
    with av.open(io.BytesIO(last_picture(frames)), "r", format="jpeg_pipe") as still:
        picture = next(still.decode(video=0))
    assert (picture.width, picture.height) == (320, 240)
    grey = picture.to_ndarray(format="gray")
    assert int(grey.max()) - int(grey.min()) < 8
    assert int(grey.mean()) == pytest.approx(80, abs=4)  # of the newest key frame, number 20


def test_what_is_no_picture_is_said_so() -> None:
    broken = [RecordedFrame(0, b"\x00\x00\x00\x01\x67" + b"\x01" * 400)]
    for read in (as_mp4, last_picture):
        with pytest.raises(Corrupt):
            read(broken)
