"""Add candidates whose names of multicast DNS must be looked up, while the answer is already on its way."""

from __future__ import annotations

import logging
from collections.abc import Sequence

from aiortc import RTCPeerConnection
from aiortc.exceptions import InvalidStateError
from aiortc.sdp import candidate_from_sdp

from mart.teleop_gateway.webrtc.ice_candidates import NamedCandidate

_log = logging.getLogger(__name__)


async def add_named(connection: RTCPeerConnection, named: Sequence[NamedCandidate]) -> None:
    """Return when each name was looked up and its candidate added, or left out where nobody answers for it."""
    for one in named:
        try:
            candidate = candidate_from_sdp(one.line)
            candidate.sdpMLineIndex = one.media_index
            await connection.addIceCandidate(candidate)
        except (InvalidStateError, ValueError, OSError) as error:
            # Closed meanwhile, garbage, or no multicast here.
            _log.debug("A candidate with a name is left out: %s", error)
