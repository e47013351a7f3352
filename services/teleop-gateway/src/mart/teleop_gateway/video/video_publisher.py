"""Publish a seat's video, and thumbnails of it, on the bus."""

from __future__ import annotations

from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.protocol import codec, keys
from mart.runtime.bus.base import Bus
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.video.encoder import RECORDED
from mart.teleop_gateway.video.live_view import SeatPicture
from mart.teleop_gateway.video.thumbnail import Thumbnail


class VideoPublisher:
    """Publish a seat's pictures on the bus: its video, and thumbnails of it. Open from its making until `close`."""

    def __init__(self, bus: Bus, seat: SeatAddress) -> None:
        room, arm = seat.room, seat.arm
        self._arm = arm
        self._video = bus.publisher(keys.video(room, arm))
        self._stills = bus.publisher(keys.still(room, arm))

    def close(self) -> None:
        """Publish nothing any more."""
        self._video.close()
        self._stills.close()

    def put(self, made: SeatPicture | Thumbnail) -> None:
        """Publish what was made, from any one thread; other streams than the recorded one are for peers only."""
        if isinstance(made, Thumbnail):
            image = CompressedImage(frame_id=self._arm, data=made.jpeg, format="jpeg")
            image.timestamp.FromNanoseconds(made.image_ns)
            self._stills.put(codec.encode(image))
        elif made.encoded.stream == RECORDED:
            video = CompressedVideo(frame_id=self._arm, data=made.encoded.data, format="h264")
            video.timestamp.FromNanoseconds(made.image_ns)
            self._video.put(codec.encode(video))
