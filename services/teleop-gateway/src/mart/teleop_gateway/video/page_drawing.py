"""Serve pages that draw the room themselves: the scene once, and the poses of every state."""

from __future__ import annotations

import asyncio
import gzip
import logging
from collections.abc import Callable
from dataclasses import dataclass

import mujoco

from mart.protocol import clock
from mart.protocol.errors import InvalidInput, MartError, Unavailable
from mart.protocol.messages import SceneReply, SceneRequest, State
from mart.protocol.tasks import Task
from mart.render import BodyPoses, export_scene
from mart.runtime.rate_limit import RateLimit
from mart.teleop_gateway.video.motion_to_photon import PictureStamps

_log = logging.getLogger(__name__)

_GZIP_LEVEL = 6


@dataclass(frozen=True)
class PoseMessage:
    """Hold one tick's poses on their way to pages."""

    data: bytes
    tick: int
    stamps: PictureStamps


@dataclass(frozen=True)
class _ExportedScene:
    model: mujoco.MjModel
    sha256: str
    compressed: bytes


class PageDrawing:
    """Hold the scene of the room's newest model, made when a page asks for it, and write poses while any page draws.

    States come on one thread of the bus; everything else on the event loop, where `sink` is called too.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop, sink: Callable[[PoseMessage], None]) -> None:
        self._loop, self._sink = loop, sink
        self._model: mujoco.MjModel | None = None
        self._task: Task | None = None
        self._exported: _ExportedScene | None = None
        self._making = asyncio.Lock()
        self._remaking: asyncio.Future[None] | None = None  # kept, or it might be collected
        self._wanted = False
        self._filmed = False
        self._poses: BodyPoses | None = None
        self._log_limit = RateLimit(1)

    def use(self, model: mujoco.MjModel, task: Task | None) -> None:
        """Take a new model of the room, and its task if known.

        Poses go on where a page draws, else when one has asked for the scene.
        """
        self._model, self._task, self._exported, self._poses = model, task, None, None
        if self._wanted:
            self._remaking = asyncio.ensure_future(self._remake())

    async def _remake(self) -> None:
        async with self._making:
            try:
                await self._scene()
            except MartError as error:  # pages hear no poses, ask for the scene, and are told the same
                _log.warning("Pages do not draw the room's new model: %s", error)

    def want(self, wanted: bool) -> None:
        """Write poses from now on, or write none."""
        self._wanted = wanted

    def film(self, filmed: bool) -> None:
        """Take that the seat shows a camera, which no page can draw; or that it does not."""
        self._filmed = filmed

    async def answer(self, request: SceneRequest) -> SceneReply:
        """Return the scene; raises Unavailable where there is no model yet, InvalidInput where pages cannot draw it."""
        if self._filmed:
            raise InvalidInput("This seat shows a real camera, whose picture comes as video.")
        async with self._making:  # it is made once, whoever asks meanwhile
            exported = await self._scene()
        known = exported.sha256 in request.known_sha256
        return SceneReply(sha256=exported.sha256, scene_gzip=b"" if known else exported.compressed)

    def offer(self, state: State, received_ns: int) -> None:
        """Write the poses of this state, if any page draws. Call it on the bus's thread."""
        poses = self._poses
        if not self._wanted or poses is None:
            return
        try:
            message = poses.message(state.integration_state, state.tick)
        except InvalidInput as error:
            if self._log_limit.allows(clock.monotonic_s()):
                _log.warning("A state was not told to pages: %s", error)
            return
        now_ns = clock.wall_ns()
        stamps = PictureStamps(received_ns, now_ns, now_ns)
        self._loop.call_soon_threadsafe(self._sink, PoseMessage(message, state.tick, stamps))

    async def _scene(self) -> _ExportedScene:
        model = self._model
        if model is None:
            raise Unavailable("The room's model is not here yet; ask for its scene again in a moment.")
        if self._exported is None or self._exported.model is not model:
            exported = await asyncio.to_thread(_export, model, self._task)
            if self._model is not model:  # replaced meanwhile
                return exported
            self._exported = exported
            self._poses = BodyPoses(model, exported.sha256)
        return self._exported


def _export(model: mujoco.MjModel, task: Task | None) -> _ExportedScene:
    scene = export_scene(model, task)
    return _ExportedScene(model, scene.sha256, gzip.compress(scene.data, _GZIP_LEVEL, mtime=0))
