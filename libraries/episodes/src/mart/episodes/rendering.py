"""Have episodes drawn as videos by `mart episodes render`, each in a process of its own, when somebody first asks."""

from __future__ import annotations

import subprocess
from importlib.metadata import entry_points
from pathlib import Path

from mart.protocol.errors import Corrupt, Unavailable
from mart.runtime.child_process import MART, start_child, stop_child

_AT_ONCE = 2


class EpisodeRenderings:
    """Draw videos in child processes, two at once. For one thread: see mart.runtime.child_process.

    log: what the children print.
    """

    def __init__(self, log: Path) -> None:
        self._log = log
        self._children: dict[Path, subprocess.Popen[bytes]] = {}

    def is_ready(self, episode: Path, video: Path, viewpoint: str = "") -> bool:
        """Return whether `video` is there; where it is not, have `episode` drawn from `viewpoint`.

        Where enough are being drawn already nothing begins: whoever waits asks again. Raises Corrupt where it could not
        be drawn, once, and Unavailable where nothing here draws.
        """
        child = self._children.get(video)
        if child is not None and child.poll() is not None:
            del self._children[video]
        if video.is_file():
            return True
        if child is None:
            self._draw(episode, video, viewpoint)
        elif child.poll() is not None:
            raise Corrupt(f"The episode {episode.stem} could not be drawn; {self._log} says why.")
        return False

    def close(self) -> None:
        """End what is being drawn."""
        for child in self._children.values():
            stop_child(child)
        self._children.clear()

    def _draw(self, episode: Path, video: Path, viewpoint: str) -> None:
        going = sum(child.poll() is None for child in self._children.values())
        if going >= _AT_ONCE:
            return
        if not entry_points(group="mart.commands.episodes", name="render"):
            raise Unavailable("Nothing here draws episodes; install the sim beside this part.")
        self._log.parent.mkdir(parents=True, exist_ok=True)
        options = ("--viewpoint", viewpoint) if viewpoint else ()
        with self._log.open("ab") as log:
            command = (MART, "episodes", "render", episode, "--out", video, *options)
            self._children[video] = start_child(command, log, {})
