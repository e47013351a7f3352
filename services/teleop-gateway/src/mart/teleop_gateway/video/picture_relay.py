"""Bring a seat's pictures from the thread that makes them to those who want them."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from mart.teleop_gateway.video.encoder import RECORDED, EncodedPicture
from mart.teleop_gateway.video.live_view import SeatPicture
from mart.teleop_gateway.video.motion_to_photon import MotionToPhoton
from mart.teleop_gateway.video.thumbnail import Thumbnail
from mart.teleop_gateway.video.video_publisher import VideoPublisher


class PictureRelay:
    """Hand each picture on: to the peers first, who wait for it, then onto the bus."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        to_peers: Callable[[EncodedPicture], None],
        publisher: VideoPublisher,
        latency: MotionToPhoton,
        on_drawn: Callable[[int], None],
        *,
        holder_draws: Callable[[], bool],
        left_out: Callable[[], bool],
        is_filmed: Callable[[], bool] = lambda: False,
    ) -> None:
        """Relay pictures. `to_peers`, and `on_drawn` with the picture's tick, are called on the loop.

        Where `holder_draws`, these are not the pictures that the holder sees, and no account of its delays is theirs.
        Where they are `left_out` of the file that is being recorded, the bus gets none; nor where they are a camera's
        (`is_filmed`), which gives the file its own.
        """
        self._is_filmed = is_filmed
        self._tick = 0
        self._holder_draws, self._left_out = holder_draws, left_out
        self._loop, self._to_peers, self._publisher, self._latency = loop, to_peers, publisher, latency
        self._on_drawn = on_drawn

    def put(self, made: SeatPicture | Thumbnail) -> None:
        """Hand on what was made. Call it on the view's thread."""
        if isinstance(made, SeatPicture):
            self._loop.call_soon_threadsafe(self._pass_on, made)
            if self._left_out() or self._is_filmed():
                return
        self._publisher.put(made)

    def _pass_on(self, picture: SeatPicture) -> None:
        self._to_peers(picture.encoded)
        if picture.encoded.stream == RECORDED and not self._holder_draws():
            # A camera shows a tick in several pictures: the first one is what the hand's effect was first seen in.
            if not (self._is_filmed() and picture.tick == self._tick):
                self._latency.on_picture(picture.tick, picture.stamps)
            self._tick = picture.tick
            self._on_drawn(picture.tick)
