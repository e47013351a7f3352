"""What a peer's answer does not wait for, and which end begins the handshake."""

from __future__ import annotations

import asyncio

import pytest
from aioice import mdns
from aiortc import RTCConfiguration, RTCPeerConnection

from mart.protocol.tokens import Role
from mart.teleop_gateway.webrtc.peer import Peer

NAME = "0c5c2a4d-1b0e-4a9e-9df4-0d3a3b1c2d3e.local"


class Unheard:
    """Listens to nothing."""

    def on_pose(self, peer: Peer, payload: bytes) -> None:
        """Nobody drives."""

    def on_status(self, peer: Peer, text: str) -> None:
        """Nobody speaks."""

    def on_speech(self, peer: Peer, timestamp: int, opus: bytes) -> None:
        """Nobody hears it."""

    def on_keyframe_wanted(self, peer: Peer) -> None:
        """Nobody watches."""

    def on_limit(self) -> None:
        """Nobody watches."""

    def on_gone(self, peer: Peer) -> None:
        """Nobody counts."""


async def offer_with_a_name() -> str:
    """A browser's: its only address is a name of multicast DNS."""
    connection = RTCPeerConnection(RTCConfiguration([]))
    connection.createDataChannel("status")
    await connection.setLocalDescription(await connection.createOffer())
    sdp = connection.localDescription.sdp
    await connection.close()
    lines = [line for line in sdp.splitlines() if not line.startswith("a=candidate")]
    lines.append(f"a=candidate:1 1 udp 2113937151 {NAME} 50000 typ host")
    return "\r\n".join(lines) + "\r\n"


@pytest.mark.anyio
async def test_an_answer_waits_for_no_name_and_leaves_the_handshake_to_the_browser(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = asyncio.Event()

    async def never(_self: mdns.MDnsProtocol, hostname: str, **_given: object) -> str | None:
        assert hostname == NAME
        asked.set()
        await asyncio.Event().wait()
        return None

    monkeypatch.setattr(mdns.MDnsProtocol, "resolve", never)
    peer = Peer(Role.PHONE, Unheard())
    try:
        answer = await asyncio.wait_for(peer.answer(await offer_with_a_name()), 20)
        assert "a=setup:passive" in answer
        await asyncio.wait_for(asked.wait(), 20)  # it is looked up all the same
    finally:
        await peer.close()
