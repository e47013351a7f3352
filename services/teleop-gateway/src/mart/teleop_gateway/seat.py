"""Serve one seat: its peers drive its arm and see its view; a policy's is watched only. Lives in a process of its own.

Peers and rooms speak, pictures come out:
- `room_feed` hands on what the room says, `webrtc.peer_messages` what peers say;
- `input.seat_input` follows the holder and turns frames into commands;
- `video.view_manager` draws and encodes, `video.picture_relay` hands pictures on;
- `video.camera_feed` shows real cameras in the place of what is drawn;
- `video.page_drawing` serves pages that draw by themselves;
- `voice.room_voice` carries what people say;
- `webrtc.offer_handler` lets peers in, `webrtc.status_broadcaster` tells them how things stand.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging

from mart.protocol import keys
from mart.protocol.messages import Event
from mart.protocol.queryables import SCENE
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Bus, Closable
from mart.runtime.serving import AsyncRequestAnswerer
from mart.teleop_gateway.input.seat_input import SeatInput
from mart.teleop_gateway.room_feed import RoomFeed
from mart.teleop_gateway.seat_events import SeatEvents
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.settings import GatewaySettings
from mart.teleop_gateway.video.camera_feed import CameraFeed
from mart.teleop_gateway.video.motion_to_photon import MotionToPhoton, report_latency
from mart.teleop_gateway.video.page_drawing import PageDrawing, PoseMessage
from mart.teleop_gateway.video.picture_relay import PictureRelay
from mart.teleop_gateway.video.quality import QUALITIES
from mart.teleop_gateway.video.seat_metrics import SeatMetrics
from mart.teleop_gateway.video.video_publisher import VideoPublisher
from mart.teleop_gateway.video.view_manager import ViewManager
from mart.teleop_gateway.voice.room_voice import RoomVoice
from mart.teleop_gateway.webrtc.ice_watch import IceWatch
from mart.teleop_gateway.webrtc.offer_handler import OfferHandler
from mart.teleop_gateway.webrtc.peer_messages import PeerMessages
from mart.teleop_gateway.webrtc.peers import Peers
from mart.teleop_gateway.webrtc.speech_rights import SpeechRights
from mart.teleop_gateway.webrtc.status_broadcaster import StatusBroadcaster

_log = logging.getLogger(__name__)

_NO_PICTURE_EVERY_S = 3.0
_PICTURE_COST_EVERY_S = 1.0


class Seat:
    """Put the parts of a seat together, and take them down in the right order."""

    def __init__(
        self, bus: AsyncBus, video_bus: Bus, settings: GatewaySettings, address: SeatAddress, secret: bytes
    ) -> None:
        """Make a seat. `video_bus` is a session of its own: pictures must never stand in a command's way.

        `secret` is what seat tokens are signed with.
        """
        self._bus, self._address, self._metrics = bus, address, SeatMetrics(address)
        self._latency, self._events = MotionToPhoton(address.arm), SeatEvents(bus, address)
        self._ice = IceWatch(settings)
        self._peers = Peers(bus, self._ice.usable)
        self._input = SeatInput(
            bus,
            address,
            hand_scale=settings.hand_scale,
            on_command=self._latency.on_command,
            on_new_holder=self._peers.drop_driving,
        )
        self._video = VideoPublisher(video_bus, address)
        loop = asyncio.get_running_loop()
        relay = PictureRelay(
            loop,
            self._peers.put,
            self._video,
            self._latency,
            self._input.on_drawn,
            holder_draws=lambda: self._peers.holder_draws,
            left_out=lambda: self._broadcaster.recorded_view.is_left_out,
            is_filmed=lambda: self._cameras.is_filmed,
        )
        self._pages = PageDrawing(loop, self._send_poses)
        self._views = ViewManager(
            bus,
            address,
            sink=relay.put,
            on_azimuth=self._input.on_camera_azimuth,
            quality=QUALITIES[settings.quality],
            pages=self._pages,
        )
        self._cameras = CameraFeed(bus, address, self._views.show, self._views.film)
        self._voice = RoomVoice(bus, address, self._peers)
        self._broadcaster = StatusBroadcaster(
            self._peers, self._input, self._views, self._cameras, self._latency
        )
        self._peers.attach(
            PeerMessages(
                peers=self._peers,
                pages=self._pages,
                seat_input=self._input,
                views=self._views,
                cameras=self._cameras,
                latency=self._latency,
                events=self._events,
                broadcaster=self._broadcaster,
                voice=self._voice,
                speech=SpeechRights(address, secret),
            )
        )
        self._feed = self._made_feed()
        self._offers = OfferHandler(address, secret, self._input, self._peers)

    async def run(self) -> None:
        """Serve until cancelled."""
        await self._ice.check()
        with contextlib.ExitStack() as stack:
            for opened in self._open():
                stack.callback(opened.close)
            try:
                # Up last and down first: whoever sees this token may send an offer.
                token = keys.alive(ServiceKind.SEAT, self._address.id)
                with contextlib.closing(self._bus.announce(token)):
                    await asyncio.gather(
                        self._broadcaster.run(),
                        self._voice.run(),
                        self._cameras.run(),
                        report_latency(self._latency, self._tell_latency),
                        self._ice.run(),
                        self._report_no_picture(),
                        self._report_picture_cost(),
                    )
            finally:
                await self._peers.close()
                await self._views.close()
                if summary := self._latency.summary():
                    _log.info("%s motion to photon: %s", self._address.id, summary)

    async def _report_no_picture(self) -> None:
        """Tell now and then, as long as it is so, that the seat cannot be drawn; until cancelled."""
        while True:
            if failure := self._views.failure():
                self._events.no_picture(failure)
            await asyncio.sleep(_NO_PICTURE_EVERY_S)

    async def _report_picture_cost(self) -> None:
        """Tell once a second what the seat's video takes, while it is drawn; until cancelled."""
        while True:
            await asyncio.sleep(_PICTURE_COST_EVERY_S)
            if picture_s := self._views.picture_s():
                self._events.picture_cost(picture_s)
            self._metrics.drawn(
                rate_hz=self._views.frames_per_s(),
                picture_s=picture_s,
                failed=bool(self._views.failure()),
                peers=len(list(self._peers)),
            )

    def _tell_latency(self, measured: Event.Latency) -> None:
        self._events.latency(measured)
        self._metrics.latency(measured)

    def _send_poses(self, message: PoseMessage) -> None:
        self._peers.put_poses(message.data)
        if self._peers.holder_draws:
            self._latency.on_picture(message.tick, message.stamps)
            self._input.on_drawn(message.tick)

    def _made_feed(self) -> RoomFeed:
        return RoomFeed(
            self._address,
            seat_input=self._input,
            views=self._views,
            cameras=self._cameras,
            pages=self._pages,
            latency=self._latency,
            events=self._events,
            broadcaster=self._broadcaster,
        )

    def _open(self) -> list[Closable]:
        scene = AsyncRequestAnswerer(SCENE, self._pages.answer)
        return [
            self._bus.serve(keys.scene(self._address.room, self._address.arm), scene),
            *self._offers.serve(self._bus),
            *self._feed.subscribe(self._bus),
            *self._voice.open(),
            self._cameras,
            self._input,
            self._events,
            self._video,
        ]
