"""Take out of a file what an operator saw: a video that browsers play, not encoded again, or a small still picture."""

from __future__ import annotations

import io
from dataclasses import dataclass
from fractions import Fraction

import av
import numpy as np
from av.video.codeccontext import VideoCodecContext
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from numpy.typing import NDArray

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.recording import video_topic

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


def frames_of(file: EpisodeFile, camera: str) -> list[RecordedFrame]:
    """Return the pictures of a camera from the first key frame on. Raises NotFound where there is none."""
    messages = file.messages(video_topic(camera))
    videos = (codec.decode(CompressedVideo, message.payload) for message in messages)
    frames = [RecordedFrame(video.timestamp.ToNanoseconds(), video.data) for video in videos]
    first = next((index for index, frame in enumerate(frames) if frame.is_key), None)
    if first is None:
        raise NotFound(f"{file.path.name} holds no picture of {camera!r}.")
    return frames[first:]


def as_mp4(frames: list[RecordedFrame]) -> bytes:
    """Return an MP4 of the same pictures at the same times. Raises Corrupt where they cannot be read."""
    video = io.BytesIO()
    try:
        with (
            av.open(io.BytesIO(frames[0].data), format="h264") as sample,
            av.open(video, "w", format="mp4") as container,
        ):
            stream = container.add_stream_from_template(sample.streams.video[0])
            before = -1
            for frame in frames:
                seconds = (frame.image_ns - frames[0].image_ns) / 1e9
                before = max(before + 1, round(seconds / _TIME_BASE))
                packet = av.Packet(frame.data)
                packet.stream, packet.time_base = stream, _TIME_BASE
                packet.pts = packet.dts = before
                packet.is_keyframe = frame.is_key
                container.mux(packet)
    except (av.FFmpegError, IndexError) as error:
        raise Corrupt(f"The recorded pictures cannot be read: {error}.") from error
    return video.getvalue()


def last_picture(frames: list[RecordedFrame]) -> bytes:
    """Return the newest key frame as a JPEG, without the tick's code. Raises Corrupt where it cannot be read."""
    newest = next(frame for frame in reversed(frames) if frame.is_key)
    try:
        decoder = VideoCodecContext.create("h264", "r")
        picture = [*decoder.decode(av.Packet(newest.data)), *decoder.decode(None)][0]
        image = picture.to_ndarray(format="rgb24").astype(np.uint8, copy=False)
        return as_jpeg(image[: round(picture.height * (1 - _TICK_CODE_SHARE))])
    except (av.FFmpegError, IndexError) as error:
        raise Corrupt(f"The recorded pictures cannot be read: {error}.") from error


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
