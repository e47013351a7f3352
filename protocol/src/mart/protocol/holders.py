"""Tell whether somebody holds a seat, from what everybody hears of it.

A holder's id is a secret between the holder and the sim: whoever knows it can leave the seat in the holder's name. What
rooms say, and what files keep, is a tag of it: the holder recognises it, others cannot go back from it, and it is
another one at every change of the seat, so that it links nobody's episodes.
"""

from __future__ import annotations

import hashlib
import hmac

from mart.protocol.messages import Seat

_TAG_BYTES = 16


def holder_tag(salt: str, arm: str, epoch: int, holder_id: str) -> str:
    """Return the tag of a seat's holder, "" for a seat that nobody in particular holds.

    salt: letters and digits that differ from room to room; it is part of the tag.
    """
    if not holder_id:
        return ""
    said = "\0".join((salt, arm, str(epoch), holder_id)).encode()
    return f"{salt}-{hashlib.blake2b(said, digest_size=_TAG_BYTES).hexdigest()}"


def is_held_by(seat: Seat, holder_id: str) -> bool:
    """Tell whether `holder_id` holds this seat."""
    salt, _, _ = seat.holder_tag.partition("-")
    tag = holder_tag(salt, seat.arm, seat.epoch, holder_id)
    return bool(tag) and hmac.compare_digest(tag.encode(), seat.holder_tag.encode())
