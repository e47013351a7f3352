"""Serve worlds on the bus (`mart replica`): requests are answered one after another, below the rooms' priority."""

from __future__ import annotations

import contextlib
import logging
import os
import queue
import threading
from collections import Counter

from mart.protocol import clock, codec, keys
from mart.protocol.errors import MartError
from mart.protocol.messages import RolloutReply, RolloutRequest, error_message
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Request
from mart.runtime.service import announced, connected
from mart.runtime.throttled_log import ThrottledLog
from mart.sim.rollout.native_process import NativeRollouts
from mart.sim.rollout.rollout_server import RolloutServer
from mart.sim.settings import ReplicaSettings
from mart.sim.world.divergence import DivergenceArchive

_log = logging.getLogger(__name__)

_LONGEST_WAIT_S = 0.5  # so that a stop is noticed


def serve_replica(settings: ReplicaSettings) -> None:
    """Answer rollout requests until the process is asked to stop."""
    os.nice(settings.niceness)
    requests: queue.SimpleQueue[Request] = queue.SimpleQueue()
    archive = DivergenceArchive(settings.diverged_dir, settings.name, clock.wall_ns)
    with (
        connected(settings, ServiceKind.REPLICA, settings.name) as service,
        contextlib.closing(service.bus.serve(keys.rollout(settings.name), requests.put)),
        announced(service),
        contextlib.closing(NativeRollouts(os.environ)) as native,
    ):
        _answer_all(RolloutServer(explain=archive.keep, native=native), requests, service.stop)


def _answer_all(server: RolloutServer, requests: queue.SimpleQueue[Request], stop: threading.Event) -> None:
    refused: Counter[str] = Counter()
    throttled_log = ThrottledLog(_log)
    while not stop.is_set():
        with contextlib.suppress(queue.Empty):
            request = requests.get(timeout=_LONGEST_WAIT_S)
            reply = _answer(server, request.payload)
            refused[reply.error.message] += bool(reply.error.message)
            request.reply(codec.encode(reply))
        throttled_log.report(refused, clock.monotonic_s())


def _answer(server: RolloutServer, payload: bytes) -> RolloutReply:
    try:
        return server.answer(codec.decode(RolloutRequest, payload), clock.monotonic_s())
    except MartError as error:
        return RolloutReply(error=error_message(error))
