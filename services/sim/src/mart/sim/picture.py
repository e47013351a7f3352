"""Write a picture as PNG."""

from __future__ import annotations

from pathlib import Path

import av

from mart.render import Image
from mart.runtime.atomic_file import PUBLIC, write_atomically


def write_png(path: Path, picture_rgb: Image) -> None:
    """Write uint8, shape (height, width, 3)."""
    frame = av.VideoFrame.from_ndarray(picture_rgb, format="rgb24")
    codec = av.CodecContext.create("png", "w")
    assert isinstance(codec, av.VideoCodecContext)
    codec.width, codec.height, codec.pix_fmt = frame.width, frame.height, "rgb24"
    packets = [*codec.encode(frame), *codec.encode(None)]
    write_atomically(path, b"".join(bytes(packet) for packet in packets), PUBLIC)
