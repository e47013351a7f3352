"""Draw an episode file as a video: its own model, its own states, any viewpoint; no task is needed, and no physics."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from contextlib import closing
from fractions import Fraction
from pathlib import Path
from typing import BinaryIO

import av
import mujoco

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import State
from mart.protocol.recording import STATE
from mart.render import Renderer, load_model
from mart.runtime.atomic_file import PUBLIC, write_atomically

_QUALITY = {"crf": "20", "preset": "veryfast"}  # of x264: no difference to see, about 1 MB a minute


def render_episode(
    path: Path,
    out: Path,
    viewpoint: str,
    width_px: int,
    height_px: int,
    *,
    on_picture: Callable[[], None] = lambda: None,
) -> int:
    """Write `out` (MP4, H.264) with one picture for each recorded state, in real time; return how many.

    on_picture: called after each.
    Raises NotFound for an unknown viewpoint, InvalidInput for a size that cannot be, Corrupt where the file does not
    hold what it should.
    """
    if width_px % 2 or height_px % 2:
        raise InvalidInput(f"A video of {width_px} x {height_px} px was asked for; both sides must be even.")
    file = EpisodeFile.open(path)
    control_hz = file.room.control_hz
    if control_hz is None:
        raise Corrupt(f"{path} does not say how many ticks a second has: repair it.")
    video = io.BytesIO()
    with closing(Renderer(_model(file), viewpoint, width_px, height_px)) as renderer:
        frames = _encode(file, renderer, video, Fraction(control_hz).limit_denominator(1000), on_picture)
    write_atomically(out, video.getvalue(), PUBLIC)
    return frames


def _model(file: EpisodeFile) -> mujoco.MjModel:
    room = file.room
    return load_model(
        file.model(),
        sha256=room.model_sha256 or "",
        mujoco_version=room.mujoco_version or "an unknown version",
        source=str(file.path),
    )


def _states(file: EpisodeFile) -> Iterator[bytes]:
    """Yield the integration states, each tick once."""
    newest = -1
    for message in file.messages(STATE):
        state = codec.decode(State, message.payload)
        if state.tick > newest:
            newest = state.tick
            yield state.integration_state


def _encode(
    file: EpisodeFile,
    renderer: Renderer,
    out: BinaryIO,
    frames_per_s: Fraction,
    on_picture: Callable[[], None],
) -> int:
    frames = 0
    with av.open(out, "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=frames_per_s, options=_QUALITY)
        stream.width, stream.height, stream.pix_fmt = renderer.width_px, renderer.height_px, "yuv420p"
        for state in _states(file):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(renderer.draw(state), format="rgb24")))
            frames += 1
            on_picture()
        container.mux(stream.encode())
    return frames
