"""A picture to packets: ours beside aiortc's own encoders, on the same rendered pictures, frame by frame in turns.

Everybody starts from the same RGB array of a moving two-arm scene at 640x480 (ours carries its 16 rows of tick code
on top) and ends with RTP payloads. Time is processor time of all threads: encoders that use more cores than one are not
cheaper for it; wall time stands beside it.

    python benchmarks/encode.py
"""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction

import av
import cv2
import numpy as np
from aiortc.codecs.base import Encoder
from aiortc.codecs.h264 import H264Encoder
from aiortc.codecs.vpx import Vp8Encoder
from report import Bar, report
from support.moving_scene import moving_scene

from mart.render import Image
from mart.teleop_gateway.video import encoder, tick_code

CONTROL_HZ = 20.0
FRAMES = 240
WARM_UP = 20
LARGEST_SHARE = 1 / 3


@dataclass
class Contender:
    """One way from a picture to packets. cpu_ms, wall_ms: one number a frame."""

    name: str
    to_packets: Callable[[Image, int], list[bytes]]
    cpu_ms: list[float] = field(default_factory=list)
    wall_ms: list[float] = field(default_factory=list)
    bytes_: list[int] = field(default_factory=list)

    def take(self, picture_rgb: Image, pts: int) -> None:
        cpu_ns, wall_ns = time.process_time_ns(), time.perf_counter_ns()
        payloads = self.to_packets(picture_rgb, pts)
        self.wall_ms.append((time.perf_counter_ns() - wall_ns) * 1e-6)
        self.cpu_ms.append((time.process_time_ns() - cpu_ns) * 1e-6)
        self.bytes_.append(sum(map(len, payloads)))

    def figures(self) -> dict[str, float]:
        """Median and spread (quartiles, 95th percentile)."""
        found = {}
        for clock_name, values in (("cpu", self.cpu_ms), ("wall", self.wall_ms)):
            for percent in (25, 50, 75, 95):
                found[f"{self.name}_{clock_name}_p{percent}_ms"] = float(
                    np.percentile(values[WARM_UP:], percent)
                )
        found[f"{self.name}_kbit_per_s"] = 8e-3 * CONTROL_HZ * float(np.mean(self.bytes_[WARM_UP:]))
        return found

    def median_ms(self) -> float:
        return float(np.median(self.cpu_ms[WARM_UP:]))


def ours(codec: encoder.Codec, packer: Encoder) -> Contender:
    encode = encoder.Encoder(encoder.Stream(codec), CONTROL_HZ).encode

    def to_packets(picture_rgb: Image, pts: int) -> list[bytes]:
        encoded = encode(encoder.to_i420(picture_rgb), pts, keyframe=False)
        packet = av.Packet(encoded.data)
        packet.pts, packet.time_base = pts, Fraction(1, encoder.CLOCK_HZ)
        return packer.pack(packet)[0]

    return Contender(codec.value.lower(), to_packets)


def theirs(name: str, stock: Encoder) -> Contender:
    def to_packets(picture_rgb: Image, pts: int) -> list[bytes]:
        frame = av.VideoFrame.from_ndarray(picture_rgb[: tick_code.VIEW_HEIGHT_PX], format="rgb24")
        frame.pts, frame.time_base = pts, Fraction(1, encoder.CLOCK_HZ)
        return stock.encode(frame)[0]

    return Contender(name, to_packets)


def main() -> None:
    cv2.setNumThreads(1)
    h264, vp8 = (ours(encoder.Codec.H264, H264Encoder()), ours(encoder.Codec.VP8, Vp8Encoder()))
    stock_h264, stock_vp8 = theirs("aiortc_h264", H264Encoder()), theirs("aiortc_vp8", Vp8Encoder())
    contenders = [h264, vp8, stock_h264, stock_vp8]
    turns = random.Random(0)
    for tick, picture_rgb in enumerate(moving_scene(CONTROL_HZ, FRAMES + WARM_UP)):
        pts = int(tick * encoder.CLOCK_HZ / CONTROL_HZ)
        for contender in turns.sample(contenders, len(contenders)):
            contender.take(picture_rgb, pts)
    bars = [
        Bar.at_most(f"h264_over_{stock.name}_cpu_p50", h264.median_ms() / stock.median_ms(), LARGEST_SHARE)
        for stock in (stock_h264, stock_vp8)
    ]
    report(
        "encode",
        {"frames": FRAMES, **h264.figures(), **vp8.figures()},
        {**stock_h264.figures(), **stock_vp8.figures()},
        bars,
    )


if __name__ == "__main__":
    main()
