"""Check texts that come from outside, before they name a file, reach a log or are kept."""

from __future__ import annotations

import os
import re

from mart.protocol.errors import InvalidInput

MAX_NAME_BYTES = 255  # of one name in a path, on every usual file system
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f]")
_SHOWN = 100


def require_plain(what: str, given: str) -> str:
    """Return `given`; raises InvalidInput, with `what` it is, where it holds control characters."""
    if _CONTROL.search(given):
        raise InvalidInput(f"{what} = {given[:_SHOWN]!r} was given; it may hold no control characters.")
    return given


def require_path(what: str, given: str) -> str:
    """Return `given`; raises InvalidInput where no file can have this path: control characters, too long a name."""
    require_plain(what, given)
    longest = max(len(os.fsencode(name)) for name in given.split("/"))
    if longest > MAX_NAME_BYTES:
        raise InvalidInput(
            f"{what} with a name of {longest} bytes was given; a name in a path has at most {MAX_NAME_BYTES}."
        )
    return given
