"""Take out of a file what an operator saw: a video that browsers play, not encoded again, or a small still picture."""

from __future__ import annotations

import io
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from typing import BinaryIO

import av
import numpy as np
from av.video.codeccontext import VideoCodecContext
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from numpy.typing import NDArray

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.errors import Corrupt, InvalidInput, NotFound
from mart.protocol.recording import video_topic

MAX_VIDEO_BYTES = 1024 * 1024 * 1024
_MAX_PICTURES = 500_000  # four hours at 30 a second
_TIME_BASE = Fraction(1, 90_000)
PICTURE_WIDTH_PX = 320
_TICK_CODE_SHARE = Fraction(16, 496)  # the strip below the picture, docs/protocol.md
_SPS = 7  # type of the NAL unit that only key frames have here


@dataclass(frozen=True)
class RecordedFrame:
    """Hold one encoded picture (H.264, Annex B). image_ns: when the world was in that state (Unix time)."""

    image_ns: int
    data: bytes

    @property
    def is_key(self) -> bool:
        """Whether decoding can begin with it."""
        start = self.data.find(b"\x00\x00\x01")
        return 0 <= start < len(self.data) - 3 and self.data[start + 3] & 0x1F == _SPS


def frames_of(file: EpisodeFile, camera: str) -> Iterator[RecordedFrame]:
    """Iterate over the pictures of a camera from the first key frame on. Raises NotFound where there is none."""
    began = False
    for message in file.messages(video_topic(camera)):
        video = codec.decode(CompressedVideo, message.payload)
        frame = RecordedFrame(_nanoseconds(video), video.data)
        began = began or frame.is_key
        if began:
            yield frame
    if not began:
        raise NotFound(f"{file.path.name} holds no picture of {camera!r}.")


def write_mp4(frames: Iterable[RecordedFrame], out: BinaryIO) -> None:
    """Write an MP4 of the same pictures at the same times, one picture in memory at a time.

    Raises Corrupt where they cannot be read and InvalidInput for a video beyond 1 GiB or 500,000 pictures.
    """
    left = iter(frames)
    first = next(left)
    try:
        with (
            av.open(io.BytesIO(first.data), format="h264") as sample,
            av.open(out, "w", format="mp4") as container,
        ):
            stream = container.add_stream_from_template(sample.streams.video[0])
            before, size_bytes = -1, 0
            for number, frame in enumerate(chain([first], left)):
                size_bytes += len(frame.data)
                if size_bytes > MAX_VIDEO_BYTES or number >= _MAX_PICTURES:
                    raise InvalidInput(
                        "The recorded video is too long to be shown here; download the episode."
                    )
                seconds = (frame.image_ns - first.image_ns) / 1e9
                before = max(before + 1, round(seconds / _TIME_BASE))
                packet = av.Packet(frame.data)
                packet.stream, packet.time_base = stream, _TIME_BASE
                packet.pts = packet.dts = before
                packet.is_keyframe = frame.is_key
                container.mux(packet)
    except (av.FFmpegError, IndexError, OverflowError) as error:
        raise Corrupt(f"The recorded pictures cannot be read: {error}.") from error


def last_picture(frames: Iterable[RecordedFrame]) -> bytes:
    """Return the newest key frame as a JPEG, without the tick's code. Raises Corrupt where it cannot be read."""
    (newest,) = deque((frame for frame in frames if frame.is_key), maxlen=1)
    try:
        decoder = VideoCodecContext.create("h264", "r")
        picture = [*decoder.decode(av.Packet(newest.data)), *decoder.decode(None)][0]
        image = picture.to_ndarray(format="rgb24").astype(np.uint8, copy=False)
        return as_jpeg(without_tick_code(image))
    except (av.FFmpegError, IndexError) as error:
        raise Corrupt(f"The recorded pictures cannot be read: {error}.") from error


def without_tick_code(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a recorded picture, shape (rows, columns, 3), without the strip below it that tells the tick."""
    return picture[: round(len(picture) * (1 - _TICK_CODE_SHARE))]


def _nanoseconds(video: CompressedVideo) -> int:
    return video.timestamp.seconds * 1_000_000_000 + video.timestamp.nanos


def as_jpeg(image: NDArray[np.uint8]) -> bytes:
    """Return an sRGB picture, shape (rows, columns, 3), as a JPEG of 320 px width."""
    rows, columns, _ = image.shape
    height_px = round(PICTURE_WIDTH_PX * rows / columns / 2) * 2
    small = av.VideoFrame.from_ndarray(image, format="rgb24").reformat(
        PICTURE_WIDTH_PX, height_px, format="yuvj420p"
    )
    encoder = VideoCodecContext.create("mjpeg", "w")
    encoder.width, encoder.height, encoder.pix_fmt = small.width, small.height, "yuvj420p"
    encoder.time_base = _TIME_BASE
    return b"".join(bytes(packet) for packet in [*encoder.encode(small), *encoder.encode(None)])
