"""Hand what peers of a seat say to the parts of the seat that it is meant for."""

from __future__ import annotations

import logging
from collections.abc import Mapping

from mart.protocol import clock
from mart.protocol.errors import Forbidden, InvalidInput
from mart.protocol.tokens import Role
from mart.teleop_gateway.input.cues import CueFilter, PressVerdict
from mart.teleop_gateway.input.driving import InputDevice
from mart.teleop_gateway.input.seat_input import SeatInput
from mart.teleop_gateway.seat_events import SeatEvents
from mart.teleop_gateway.video.camera_feed import CameraFeed
from mart.teleop_gateway.video.encoder import Stream
from mart.teleop_gateway.video.motion_to_photon import MotionToPhoton, PageDraws
from mart.teleop_gateway.video.page_drawing import PageDrawing
from mart.teleop_gateway.video.view_manager import ViewManager
from mart.teleop_gateway.voice.room_voice import RoomVoice
from mart.teleop_gateway.webrtc import status_channel
from mart.teleop_gateway.webrtc.peer import Peer
from mart.teleop_gateway.webrtc.peers import Peers
from mart.teleop_gateway.webrtc.speech_rights import SpeechRights
from mart.teleop_gateway.webrtc.status_broadcaster import StatusBroadcaster

_log = logging.getLogger(__name__)

_DEVICES = {Role.BROWSER: InputDevice.KEYBOARD, Role.PHONE: InputDevice.PHONE}


class PeerMessages:
    """Listen to the peers of one seat. A viewer has no device: nothing that it says moves or selects anything."""

    def __init__(
        self,
        *,
        peers: Peers,
        pages: PageDrawing,
        seat_input: SeatInput,
        views: ViewManager,
        cameras: CameraFeed,
        latency: MotionToPhoton,
        events: SeatEvents,
        broadcaster: StatusBroadcaster,
        voice: RoomVoice,
        speech: SpeechRights,
    ) -> None:
        self._peers, self._pages = peers, pages
        self._voice, self._speech = voice, speech
        self._input, self._views, self._latency = seat_input, views, latency
        self._cameras, self._events, self._broadcaster = cameras, events, broadcaster
        self._cues = CueFilter()

    def on_joined(self, peer: Peer) -> None:
        """Listen to the device of a new peer."""
        _log.info("A %s joined", peer.role)
        if peer.role in _DEVICES:
            self._input.connect(_DEVICES[peer.role])

    def on_left(self, peer: Peer) -> None:
        """Forget the device of a peer that is gone."""
        _log.info("A %s left", peer.role)
        if peer.role in _DEVICES:
            self._input.disconnect(_DEVICES[peer.role])

    def on_watched(self, limits_bps: Mapping[Stream, float]) -> None:
        """Encode what somebody watches, and nothing else."""
        self._views.set_streams(limits_bps)
        self._pages.want(self._peers.any_draws)
        self._broadcaster.rest_where_unneeded()

    def on_keyframe_wanted(self, stream: Stream) -> None:
        """Make the next picture one that needs none before it."""
        self._views.request_keyframe(stream)

    def on_pose(self, peer: Peer, payload: bytes) -> None:
        """Drive the arm by a phone frame."""
        self._input.receive(_DEVICES[peer.role], payload)
        self._broadcaster.tell_changes()

    def on_speech(self, peer: Peer, timestamp: int, opus: bytes) -> None:
        """Let the room hear what a peer says, as long as it may speak."""
        if self._speech.may_speak(peer, clock.wall_ns() * 1e-9):
            self._voice.say(peer, drives=peer.role in _DEVICES, timestamp=timestamp, opus=opus)

    def on_status(self, peer: Peer, text: str) -> None:
        """Do what a message on the status channel asks; one that nobody understands is left out."""
        try:
            message = status_channel.parse(text)
        except InvalidInput as error:
            _log.debug("A %s said what nobody understands: %s", peer.role, error)
            return
        match message:
            case status_channel.PingMessage():
                peer.send_status(status_channel.pong(message, clock.wall_ns(), peer.limit_bps))
            case status_channel.ClockMessage(offset_ns):
                peer.clock_offset_ns = offset_ns
            case status_channel.SeenMessage(tick, t_us) if peer.clock_offset_ns is not None:
                if peer.role is Role.BROWSER:
                    self._latency.on_seen(tick, int(t_us * 1000) + peer.clock_offset_ns)
            case status_channel.DrawingMessage():
                self._on_drawing(peer, message)
            case status_channel.TokenMessage(token):
                self._renew_speech(peer, token)
        if peer.role in _DEVICES:
            self._do_for_holder(peer, _DEVICES[peer.role], message)

    def _renew_speech(self, peer: Peer, token: str) -> None:
        try:
            self._speech.renew(peer, token)
        except Forbidden as error:
            _log.info("A %s may not speak on: %s", peer.role, error)

    def _on_drawing(self, peer: Peer, message: status_channel.DrawingMessage) -> None:
        if peer.role is Role.PHONE:
            return
        is_on = message.on and not self._cameras.is_filmed
        self._peers.set_draws(peer, is_on)
        if peer.role is Role.BROWSER:
            self._latency.draws = PageDraws(is_on, message.p50_ms, message.p95_ms, message.per_s)

    def _do_for_holder(self, peer: Peer, device: InputDevice, message: status_channel.PeerMessage) -> None:
        match message:
            case status_channel.ClockMessage(offset_ns):
                self._input.set_clock(device, offset_ns)
            case status_channel.SeenMessage(tick) if device is InputDevice.KEYBOARD:
                self._input.on_displayed(tick)
            case status_channel.SelectInputMessage(chosen):
                self._input.select(chosen)
                self._broadcaster.tell_changes()
            case status_channel.ChooseCameraMessage(camera) if device is InputDevice.KEYBOARD:
                self._cameras.choose(camera)
            case status_channel.CueMessage(cue, press_us):
                verdict = self._cues.judge(press_us, clock.monotonic_s())
                if verdict is PressVerdict.SAID:
                    self._events.cue(cue)
                elif verdict is PressVerdict.TOO_SOON:
                    peer.send_status(status_channel.cue_refused(message))
