"""Draw what an episode's states show where no picture was recorded: a small still at once, videos in their own time."""

from __future__ import annotations

import hashlib
import tempfile
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from mart.episodes.reader import EpisodeFile
from mart.episodes.rendering import EpisodeRenderings
from mart.protocol import codec
from mart.protocol.errors import NotFound, Unavailable
from mart.protocol.messages import State
from mart.protocol.recording import STATE
from mart.protocol.tasks import SHARED_VIEWPOINT
from mart.recorder.catalogue.pictures import PICTURE_WIDTH_PX, as_jpeg

if TYPE_CHECKING:
    from mart.render import Renderer

_HEIGHT_PX = PICTURE_WIDTH_PX * 3 // 4
_MAX_VIDEOS = 32


class Drawings:
    """Draw on the thread that made it. Videos are kept in a folder of its own until `close`, the newest 32.

    log: what the processes that draw videos print.
    """

    def __init__(self, log: Path) -> None:
        self._renderings = EpisodeRenderings(log)
        self._made: tempfile.TemporaryDirectory[str] | None = None
        self._renderer: tuple[str, Renderer] | None = None  # of the newest model: most episodes share it

    def close(self) -> None:
        """End what is being drawn, and forget what was."""
        self._renderings.close()
        self._forget_renderer()
        if self._made is not None:
            self._made.cleanup()

    def still(self, file: EpisodeFile) -> bytes:
        """Return the last state as a JPEG, 320 px wide, from the front.

        Raises NotFound where there is no state or no such viewpoint, Corrupt where the model is not what the file says,
        Unavailable where this machine draws nothing.
        """
        last = b""
        for message in file.messages(STATE):
            last = message.payload
        if not last:
            raise NotFound(f"{file.path.name} holds no states.")
        return as_jpeg(self._renderer_of(file).draw(codec.decode(State, last).integration_state))

    def video(self, file: EpisodeFile, viewpoint: str) -> Path | None:
        """Return where the video from `viewpoint` is, one picture for each tick; None while it is being drawn.

        Raises as `EpisodeRenderings.is_ready` does.
        """
        status = file.path.stat()
        key = f"{file.path}\n{status.st_size}\n{status.st_mtime_ns}\n{viewpoint}".encode()
        video = self._folder() / f"{hashlib.sha256(key).hexdigest()[:32]}.mp4"
        if not self._renderings.is_ready(file.path, video, viewpoint):
            return None
        video.touch()
        for old in sorted(video.parent.glob("*.mp4"), key=lambda path: -path.stat().st_mtime_ns)[
            _MAX_VIDEOS:
        ]:
            old.unlink()
        return video

    def _folder(self) -> Path:
        try:
            self._made = self._made or tempfile.TemporaryDirectory(prefix="mart-drawn-")
        except OSError as error:
            raise Unavailable(f"Drawn videos can be kept nowhere here: {error}.") from error
        return Path(self._made.name)

    def _renderer_of(self, file: EpisodeFile) -> Renderer:
        # Here, not above: whoever looks at recorded pictures only needs no OpenGL.
        from mart.render import Renderer, load_model

        sha256 = file.room.model_sha256 or ""
        if self._renderer is None or self._renderer[0] != sha256:
            version = file.room.mujoco_version or "an unknown version"
            model = load_model(file.model(), sha256=sha256, mujoco_version=version, source=file.path.name)
            self._forget_renderer()
            self._renderer = sha256, Renderer(model, SHARED_VIEWPOINT, PICTURE_WIDTH_PX, _HEIGHT_PX)
        return self._renderer[1]

    def _forget_renderer(self) -> None:
        if self._renderer is not None:
            with closing(self._renderer[1]):
                self._renderer = None
