"""A seat's pictures on their way onto the bus: its video, and stills of it."""

from __future__ import annotations

from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.protocol import codec, keys
from mart.runtime.bus.base import Bus
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.video.encoder import Codec
from mart.teleop_gateway.video.live_view import SeatPicture
from mart.teleop_gateway.video.thumbnail import Thumbnail


class VideoPublisher:
    """Open from its making until `close`."""

    def __init__(self, bus: Bus, seat: SeatAddress) -> None:
        room, arm = seat.room, seat.arm
        self._arm = arm
        self._video = bus.publisher(keys.video(room, arm))
        self._stills = bus.publisher(keys.still(room, arm))

    def close(self) -> None:
        self._video.close()
        self._stills.close()

    def put(self, made: SeatPicture | Thumbnail) -> None:
        """VP8 is for peers only. From any one thread."""
        if isinstance(made, Thumbnail):
            image = CompressedImage(frame_id=self._arm, data=made.jpeg, format="jpeg")
            image.timestamp.FromNanoseconds(made.image_ns)
            self._stills.put(codec.encode(image))
        elif made.encoded.codec is Codec.H264:
            video = CompressedVideo(frame_id=self._arm, data=made.encoded.data, format="h264")
            video.timestamp.FromNanoseconds(made.image_ns)
            self._video.put(codec.encode(video))
