"""Name the cameras of a room: `arm0` and `arm0.wrist` are those of one seat, `table` is one of every seat.

In keys, files and messages a dot is written as a hyphen: `arm0-wrist`, the camera's id.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from mart.protocol.errors import InvalidInput

MAX_CAMERAS = 12  # of a room; a recorder keeps the newest pictures of 16 views
_NAME = re.compile(r"([a-z][a-z0-9_]{0,23})(?:\.([a-z][a-z0-9_]{0,23}))?")
_ARM = re.compile(r"arm\d+")


def camera_id(name: str) -> str:
    """Return a camera's id. Raises InvalidInput for what is no name, which may be an address: it is not repeated."""
    found = _NAME.fullmatch(name)
    if found is None or (found[2] and not _ARM.fullmatch(found[1])):
        raise InvalidInput(
            "A camera was given without a name that is allowed; write arm0, arm0.wrist or table: small letters, digits "
            "and _, at most 24, and a dot only behind the arm whose seat it is for."
        )
    return name.replace(".", "-")


def camera_title(camera: str) -> str:
    """Return what people call the camera with this id: its name."""
    return camera.replace("-", ".")


def camera_in_words(camera: str) -> str:
    """Return the camera with this id as a sentence names it: "the camera wrist of arm0"."""
    head, _, part = camera.partition("-")
    if not arm_of_camera(camera):
        return f"the camera {head}"
    return f"the camera {part} of {head}" if part else f"the camera of {head}"


def arm_of_camera(camera: str) -> str:
    """Return the arm whose seat the camera with this id is for; empty where it is for every seat."""
    head = camera.partition("-")[0]
    return head if _ARM.fullmatch(head) else ""


def cameras_of_seat(cameras: Iterable[str], arm: str) -> tuple[str, ...]:
    """Return the ids of those that the seat of `arm` can show: its own first, then those of every seat."""
    known = list(cameras)
    own = [one for one in known if arm_of_camera(one) == arm]
    return (*sorted(own), *(one for one in known if not arm_of_camera(one)))
