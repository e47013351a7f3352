"""Videos of kept rollouts, rendered by `mart episodes render` when somebody first asks."""

from __future__ import annotations

import subprocess
from importlib.metadata import entry_points
from pathlib import Path

from mart.protocol.errors import Corrupt, NotFound, Unavailable
from mart.protocol.messages import TrainerReply
from mart.runtime.child_process import MART, start_child, stop_child

PIECE_BYTES = 1024 * 1024
MAX_BYTES = 64 * PIECE_BYTES
_AT_ONCE = 2


class Videos:
    """Render kept rollouts and hand the videos out in pieces. For one thread: see mart.runtime.child_process.

    log: what the renderers print.
    """

    def __init__(self, log: Path) -> None:
        self._log = log
        self._renderers: dict[Path, subprocess.Popen[bytes]] = {}

    def piece(self, rollout: Path, offset: int) -> TrainerReply.Video:
        """Return a piece of the video beside an episode file; not ready while it is rendered.

        Raises NotFound without that file, Corrupt where it cannot be rendered, Unavailable where nothing renders here.
        """
        if not rollout.is_file():
            raise NotFound(
                f"There is no rollout {rollout.stem!r} of this job; its evaluations name those that were kept."
            )
        video = rollout.with_suffix(".mp4")
        if not video.is_file():
            self._render(rollout, video)
            return TrainerReply.Video(ready=False)
        size = min(video.stat().st_size, MAX_BYTES)
        with video.open("rb") as file:
            file.seek(min(offset, size))
            return TrainerReply.Video(ready=True, piece=file.read(PIECE_BYTES), size_bytes=size)

    def close(self) -> None:
        for renderer in self._renderers.values():
            stop_child(renderer)

    def _render(self, rollout: Path, video: Path) -> None:
        """Start rendering, unless enough are being rendered already: whoever waits asks again."""
        renderer = self._renderers.get(rollout)
        if renderer is not None and renderer.poll() is not None:
            del self._renderers[rollout]
            raise Corrupt(f"The rollout {rollout.stem} could not be rendered; {self._log} says why.")
        going = sum(renderer.poll() is None for renderer in self._renderers.values())
        if renderer is None and going < _AT_ONCE:
            self._renderers[rollout] = self._start(rollout, video)

    def _start(self, rollout: Path, video: Path) -> subprocess.Popen[bytes]:
        if not entry_points(group="mart.commands", name="episodes"):
            raise Unavailable("Nothing here renders episodes; install the recorder beside the trainer.")
        self._log.parent.mkdir(parents=True, exist_ok=True)
        with self._log.open("ab") as log:
            return start_child((MART, "episodes", "render", rollout, "--out", video), log, {})
