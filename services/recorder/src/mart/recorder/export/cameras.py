"""Say which pictures an export has: whose view, how large, and what of it besides colours."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import InvalidInput

_SMALLEST_PX, _LARGEST_PX = 16, 1024
MOST_CAMERAS = 12
_FORM = re.compile(r"(?P<name>[^:]+):(?P<width>\d{1,5})x(?P<height>\d{1,5})")


@dataclass(frozen=True)
class CameraRequest:
    """Ask for the pictures of one camera, of the model's or a real one, at a size in pixels."""

    name: str
    width_px: int
    height_px: int

    @classmethod
    def parse(cls, text: str) -> CameraRequest:
        """Read `arm0:224x224`. Raises InvalidInput for anything else, and for sizes that video cannot have."""
        found = _FORM.fullmatch(text)
        if found is None:
            raise InvalidInput(f"--camera {text} was given; give NAME:WIDTHxHEIGHT, such as arm0:224x224.")
        sides = int(found["width"]), int(found["height"])
        if any(side % 2 or not _SMALLEST_PX <= side <= _LARGEST_PX for side in sides):
            raise InvalidInput(
                f"--camera {text} was given; each side must be even, and from {_SMALLEST_PX} to {_LARGEST_PX} px."
            )
        return cls(found["name"], *sides)

    @property
    def key(self) -> str:
        """The name as a part of a feature's name, where dots and slashes have a meaning."""
        return re.sub(r"[^A-Za-z0-9_-]", "_", self.name)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns and channels."""
        return self.height_px, self.width_px, 3

    def __str__(self) -> str:
        return f"{self.name}:{self.width_px}x{self.height_px}"


def parse_cameras(texts: Sequence[str]) -> tuple[CameraRequest, ...]:
    """Read all that was asked for. Raises InvalidInput for too many, and where two would have one name."""
    cameras = tuple(map(CameraRequest.parse, texts))
    if len(cameras) > MOST_CAMERAS:
        raise InvalidInput(f"{len(cameras)} cameras were given; an export has at most {MOST_CAMERAS}.")
    if len({camera.key for camera in cameras}) < len(cameras):
        raise InvalidInput("A camera was given twice; give each once, at one size.")
    return cameras


def captured_cameras(
    episodes: Sequence[LabelledEpisode], cameras: Sequence[CameraRequest]
) -> tuple[str, ...]:
    """Return which of the cameras were real ones; all others are drawn from the states.

    Raises InvalidInput where a camera is real in some episodes and not in others, and where pictures would have to be
    drawn of arms that were measured: what lay around them is in no state.
    """
    if not cameras:
        return ()
    recorded = [set(episode.open().episode.captured_cameras or ()) for episode in episodes]
    for camera in cameras:
        real = sum(camera.name in names for names in recorded)
        if 0 < real < len(episodes):
            raise InvalidInput(
                f"The camera {camera.name!r} is a real one in {real} of {len(episodes)} episodes and drawn in the "
                "others; export them by themselves."
            )
        measured = [one for one in episodes if one.measured_arms]
        if not real and measured:
            known = ", ".join(sorted(set.union(*recorded))) or "none"
            raise InvalidInput(
                f"{measured[0].file_path} has real arms, around which nothing is known that could be drawn; there are "
                f"no pictures of {camera.name!r} in it. Cameras that were captured: {known}."
            )
    return tuple(camera.name for camera in cameras if camera.name in recorded[0])
