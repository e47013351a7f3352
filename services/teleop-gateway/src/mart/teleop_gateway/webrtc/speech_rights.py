"""Decide at every packet who may still speak to the room.

Whoever drives may as long as they hold the seat, whose next holder ends their connection. A host who watches may as
long as their token is good, which the web service renews while they host.
"""

from __future__ import annotations

from mart.protocol.errors import Forbidden
from mart.protocol.tokens import Role
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.webrtc.authorization import authorize_offer
from mart.teleop_gateway.webrtc.peer import Peer


class SpeechRights:
    """Keep account of the peers of one seat. `secret` is what seat tokens are signed with."""

    def __init__(self, seat: SeatAddress, secret: bytes) -> None:
        self._seat, self._secret = seat, secret

    def may_speak(self, peer: Peer, now_unix_s: float) -> bool:
        """Tell whether what a peer says is to be heard."""
        return bool(peer.speaks_as) and (peer.role is not Role.VIEWER or now_unix_s < peer.speaks_until_s)

    def renew(self, peer: Peer, token: str) -> None:
        """Let a peer speak for as long as a newer token says. Raises Forbidden for one that is not its own."""
        claims = authorize_offer(token, self._secret, self._seat, peer.role)
        if claims.holder_id != peer.holder_id or not claims.speaks_as:
            raise Forbidden("The token of somebody else, or of one who hears only, was given to speak with.")
        peer.speaks_until_s = claims.expires_s
