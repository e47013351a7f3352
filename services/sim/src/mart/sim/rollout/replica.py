"""Serve worlds on the bus (`mart replica`): requests are answered one after another, below the rooms' priority."""

from __future__ import annotations

import contextlib
import logging
import os
import threading
from collections import Counter
from collections.abc import Callable

from mart.protocol import clock, keys
from mart.protocol.errors import MartError
from mart.protocol.messages import RolloutReply, RolloutRequest
from mart.protocol.queryables import ROLLOUT
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Request
from mart.runtime.service import announced, connected
from mart.runtime.serving import BoundedInbox, RequestAnswerer
from mart.runtime.throttled_log import ThrottledLog
from mart.sim.rollout.native_process import NativeRollouts
from mart.sim.rollout.rollout_server import RolloutServer
from mart.sim.settings import ReplicaSettings
from mart.sim.world.divergence import DivergenceArchive

_log = logging.getLogger(__name__)

_LONGEST_WAIT_S = 0.5  # so that a stop is noticed
_MAX_WAITING = 256


def serve_replica(settings: ReplicaSettings) -> None:
    """Answer rollout requests until the process is asked to stop."""
    os.nice(settings.niceness)
    inbox = BoundedInbox[Request](_MAX_WAITING)
    archive = DivergenceArchive(settings.diverged_dir, settings.name, clock.wall_ns)
    with (
        connected(settings, ServiceKind.REPLICA, settings.name) as service,
        contextlib.closing(service.bus.serve(keys.rollout(settings.name), inbox.put)),
        announced(service),
        contextlib.closing(NativeRollouts(os.environ)) as native,
    ):
        _answer_all(RolloutServer(explain=archive.keep, native=native), inbox, service.stop)


def _answer_all(server: RolloutServer, inbox: BoundedInbox[Request], stop: threading.Event) -> None:
    refused: Counter[str] = Counter()
    throttled_log = ThrottledLog(_log)

    def on_refused(error: MartError) -> None:
        refused[str(error)] += 1

    answerer = rollout_answerer(server, on_refused)
    while not stop.is_set():
        request = inbox.take(_LONGEST_WAIT_S)
        if request is not None:
            answerer.respond(request)
        throttled_log.report(refused, clock.monotonic_s())


def rollout_answerer(
    server: RolloutServer, on_refused: Callable[[MartError], None] | None = None
) -> RequestAnswerer[RolloutRequest, RolloutReply]:
    """Return what answers encoded requests with `server`."""
    return RequestAnswerer(ROLLOUT, lambda request: server.answer(request, clock.monotonic_s()), on_refused)
