"""How far the ticks in the recorded pictures of an episode are from those of its log at the same times."""

from __future__ import annotations

from pathlib import Path

import av
import numpy as np
from av.video.codeccontext import VideoCodecContext
from numpy.typing import NDArray

from mart.episodes.reader import open_episode
from mart.recorder.catalogue.pictures import frames_of
from mart.teleop_gateway.video import tick_code


def ticks_apart(path: Path, arm: str) -> NDArray[np.int64]:
    """Of each picture of an arm's operator: from the tick in its strip to that of the last state at its time."""
    file, decoder = open_episode(path), VideoCodecContext.create("h264", "r")
    decoder.thread_count = 1
    stamps = np.array([(state.stamps.stepped_ns, state.tick) for state in file.states()])
    apart = []
    for frame in frames_of(file, arm):
        for picture in decoder.decode(av.Packet(frame.data)):
            shown = tick_code.read(picture.to_ndarray(format="gray").astype(np.uint8, copy=False))
            row = max(0, int(np.searchsorted(stamps[:, 0], frame.image_ns, side="right")) - 1)
            if shown is None:
                raise SystemExit(f"{path}: a picture of {arm} shows no tick.")
            apart.append(abs(shown - int(stamps[row, 1])))
    return np.array(apart)
