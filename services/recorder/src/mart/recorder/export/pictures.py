"""Give the pictures of an episode, one for each of its states: drawn anew, or the recorded ones of a real camera."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from functools import cached_property
from typing import TYPE_CHECKING, Any

import av
import numpy as np
from av.video.codeccontext import VideoCodecContext
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt, InvalidInput
from mart.recorder.catalogue.pictures import frames_of, without_tick_code
from mart.recorder.export.cameras import CameraRequest

if TYPE_CHECKING:
    import mujoco

RGB, DEPTH, SEGMENTATION = "image", "depth", "segmentation"


class EpisodePictures:
    """Give the pictures of one episode: captured ones of its real cameras, all others drawn in the world it holds.

    For one thread.
    """

    def __init__(self, file: EpisodeFile, captured: Sequence[str]) -> None:
        """Read the episode of `file`. captured: which cameras were real ones."""
        self._file = file
        self._captured = captured

    def of(self, data: EpisodeData, camera: CameraRequest, kind: str = RGB) -> Iterator[NDArray[Any]]:
        """Yield one picture for each state of the data, T + 1 in all, one at a time in memory.

        kind: RGB (uint8, shape (height, width, 3)), DEPTH (metres, float32) or SEGMENTATION (numbers of the model's
        bodies, int32), both of shape (height, width). Raises NotFound, which names those that are there, for an unknown
        camera, Unavailable where this machine draws nothing, InvalidInput for more than colours of a real camera, and
        Corrupt where the file's model or pictures cannot be read.
        """
        if camera.name not in self._captured:
            return self._drawn(data, camera, kind)
        if kind != RGB:
            raise InvalidInput(
                f"{camera.name!r} is a real camera, of which there is no {kind}; leave that out."
            )
        return captured_pictures(self._file, camera, data.sent_ns)

    def bodies(self) -> dict[int, str]:
        """Return the names of the bodies that a segmentation numbers."""
        return {number: self._model.body(number).name for number in range(self._model.nbody)}

    def _drawn(self, data: EpisodeData, camera: CameraRequest, kind: str) -> Iterator[NDArray[Any]]:
        # Here, not above: whoever exports numbers needs no OpenGL.
        from mart.render import Renderer

        with closing(Renderer(self._model, camera.name, camera.width_px, camera.height_px)) as renderer:
            draw: Callable[[bytes], NDArray[Any]] = renderer.draw
            if kind != RGB:
                draw = renderer.draw_depth if kind == DEPTH else renderer.draw_segmentation
            for state in data.integration_states.astype("<f8", copy=False):
                yield draw(state.tobytes())

    @cached_property
    def _model(self) -> mujoco.MjModel:
        from mart.render import load_model

        room = self._file.room
        return load_model(
            self._file.model(),
            sha256=room.model_sha256 or "",
            mujoco_version=room.mujoco_version or "an unknown version",
            source=self._file.path.name,
        )


def captured_pictures(
    file: EpisodeFile, camera: CameraRequest, at_ns: NDArray[np.int64]
) -> Iterator[NDArray[np.uint8]]:
    """Yield, for each of these times (Unix time, rising), the newest picture that had been captured by then.

    Before the first one, that one. Each is scaled to the camera's size: uint8, shape (height, width, 3). Raises
    NotFound where there is no picture and Corrupt where they cannot be read.
    """
    frames = _decoded(file, camera.name)
    _, newest = next(frames)
    after = next(frames, None)
    picture = _scaled(newest, camera)
    for wanted_ns in at_ns.tolist():
        is_newer = False
        while after is not None and after[0] <= wanted_ns:
            newest, is_newer = after[1], True
            after = next(frames, None)
        if is_newer:
            picture = _scaled(newest, camera)
        yield picture


def _decoded(file: EpisodeFile, camera: str) -> Iterator[tuple[int, av.VideoFrame]]:
    """Yield each picture of a camera with when it was captured (Unix time, nanoseconds)."""
    decoder = VideoCodecContext.create("h264", "r")
    decoder.thread_count = 1
    found = False
    try:
        for frame in frames_of(file, camera):
            packet = av.Packet(frame.data)
            packet.pts = frame.image_ns
            for picture in decoder.decode(packet):
                found = True
                yield picture.pts or frame.image_ns, picture
        for picture in decoder.decode(None):
            found = True
            yield picture.pts or 0, picture
    except av.FFmpegError as error:
        raise Corrupt(f"{file.path}: the pictures of {camera!r} cannot be read: {error}.") from error
    if not found:
        raise Corrupt(f"{file.path}: none of the pictures of {camera!r} can be read.")


def _scaled(frame: av.VideoFrame, camera: CameraRequest) -> NDArray[np.uint8]:
    picture = without_tick_code(frame.to_ndarray(format="rgb24").astype(np.uint8, copy=False))
    cropped = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
    scaled = cropped.reformat(camera.width_px, camera.height_px, format="rgb24", interpolation="AREA")
    return scaled.to_ndarray().astype(np.uint8, copy=False)
