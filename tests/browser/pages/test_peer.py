"""A page's connection to a gateway, where it cannot come about."""

from __future__ import annotations

from tests.browser.pages.conftest import Run


def test_a_browser_without_webrtc_is_told_so(run: Run) -> None:
    script = """async ({ Peer }) => {
      const kept = globalThis.RTCPeerConnection;
      delete globalThis.RTCPeerConnection;
      const said = await Peer.connect({ iceServers: [] }).catch(({ message }) => message);
      globalThis.RTCPeerConnection = kept;
      return said;
    }"""
    assert run("link/peer.js", script).startswith("This browser has no WebRTC.")
