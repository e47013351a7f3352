"""Count what an offer asks for before anything is made for it. Pure."""

from __future__ import annotations

import re
from dataclasses import dataclass

from mart.protocol.errors import InvalidInput
from mart.teleop_gateway.voice.lanes import LANES

_SECTION = re.compile(r"^m=(\w+)", re.MULTILINE)


@dataclass(frozen=True)
class OfferedMedia:
    """Tell whether an offer has video, and how many audio sections."""

    video: bool
    audio: int


def offered_media(sdp: str, *, phone: bool) -> OfferedMedia:
    """Return what an offer asks for; raises InvalidInput where that is more than its peer can get."""
    kinds = _SECTION.findall(sdp)
    if not kinds:
        raise InvalidInput("An offer without any section was given; a data channel is needed at least.")
    video, audio = kinds.count("video"), kinds.count("audio")
    most_video, most_audio = (0, 1) if phone else (1, LANES)
    if video > most_video or audio > most_audio:
        raise InvalidInput(
            f"{video} video and {audio} audio sections were given; {most_video} and {most_audio} are allowed."
        )
    return OfferedMedia(video > 0, audio)
