"""Hand out videos of kept rollouts, which are drawn when somebody first asks."""

from __future__ import annotations

from pathlib import Path

from mart.episodes.rendering import EpisodeRenderings
from mart.protocol.errors import NotFound
from mart.protocol.messages import TrainerReply

PIECE_BYTES = 1024 * 1024
MAX_BYTES = 64 * PIECE_BYTES


class Videos:
    """Hand out the video beside each kept rollout in pieces. For one thread, as `EpisodeRenderings` is.

    log: what those who draw print.
    """

    def __init__(self, log: Path) -> None:
        self._renderings = EpisodeRenderings(log)

    def piece(self, rollout: Path, offset: int) -> TrainerReply.Video:
        """Return a piece of the video beside an episode file; not ready while it is drawn.

        Raises NotFound without that file, Corrupt where it cannot be drawn, Unavailable where nothing draws here.
        """
        if not rollout.is_file():
            raise NotFound(
                f"There is no rollout {rollout.stem!r} of this job; its evaluations name those that were kept."
            )
        video = rollout.with_suffix(".mp4")
        if not self._renderings.is_ready(rollout, video):
            return TrainerReply.Video(ready=False)
        size = min(video.stat().st_size, MAX_BYTES)
        with video.open("rb") as file:
            file.seek(min(offset, size))
            return TrainerReply.Video(ready=True, piece=file.read(PIECE_BYTES), size_bytes=size)

    def close(self) -> None:
        """End what is being drawn."""
        self._renderings.close()
