"""The bus on Zenoh: the only file that imports it.

Its settings, and their reasons, are in `zenoh_settings`.
"""

from __future__ import annotations

import contextlib
import json
import tempfile
import threading
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any
from uuid import uuid4

import zenoh
import zenoh.ext

from mart.protocol import clock, keys
from mart.protocol.errors import Unavailable
from mart.protocol.keys import Priority, Topic
from mart.runtime.bus import zenoh_settings
from mart.runtime.bus.admission import admitted_settings, confirm_rights, require_rights
from mart.runtime.bus.base import AliveHandler, Bus, Closable, Handler, Publisher, RequestHandler, Sample
from mart.runtime.bus.log_failures import log_failures
from mart.runtime.bus.repetitions import Repetitions
from mart.runtime.bus.zenoh_settings import Settings
from mart.runtime.certificates.identity import BusIdentity

_HEARTBEAT_S = 0.5  # how soon a subscriber learns that it missed the newest, where nothing follows it
_ASKED_BACK_S = 120.0  # by a subscriber that is new
_FIRST_REST_S = 0.05  # before a query that was dropped is asked again; doubled each time

_PRIORITY = {
    Priority.REAL_TIME: zenoh.Priority.REAL_TIME,
    Priority.HIGH: zenoh.Priority.DATA_HIGH,
    Priority.NORMAL: zenoh.Priority.DATA,
    Priority.LOW: zenoh.Priority.DATA_LOW,
    Priority.BACKGROUND: zenoh.Priority.BACKGROUND,
}


class ZenohBus(Bus):
    def __init__(self, session: zenoh.Session, *, routes: bool = False) -> None:
        self._session, self._routes = session, routes
        self._watched: dict[_Declared, set[str]] = {}  # the keys that each watch knows to be alive
        self._declared: set[_Declared] = set()  # a handle that nobody holds would undeclare itself

    @classmethod
    def connect(
        cls, endpoint: str, wait_for_router: bool = True, identity_dir: Path | None = None
    ) -> ZenohBus:
        """A client of the router at `endpoint` ("tcp/127.0.0.1:7447"), with the secret that `bus_secret` finds for it.

        Raises Unavailable where no router answers and `wait_for_router` is False, else keeps trying; Forbidden where
        the router admits only who knows its secret, or shows a certificate of its own, and none here is that.

        identity_dir: the folder of the certificate to show, where it is not the one of `identity_for`.
        """
        shown = admitted_settings(
            endpoint, partial(_opens, endpoint), identity_dir, wait_for_router=wait_for_router
        )
        bus = cls(_open(zenoh_settings.client(endpoint, wait_for_router) | shown, endpoint))
        require_rights(endpoint, bus)
        return bus

    @classmethod
    def route(cls, endpoint: str, secret: bytes | None = None) -> ZenohBus:
        """A router that listens at `endpoint` and admits who knows `secret`, or everybody where there is none.

        Raises Unavailable where the address is taken.
        """
        if secret is None:
            return cls(_open(zenoh_settings.router(endpoint), endpoint), routes=True)
        with tempfile.NamedTemporaryFile(prefix="mart-") as users:  # readable by this user alone
            users.write(zenoh_settings.users(secret))
            users.flush()
            return cls(_open(zenoh_settings.router(endpoint, users.name), endpoint), routes=True)

    @classmethod
    def route_secured(cls, endpoint: str, identity: BusIdentity, access: dict[str, Any]) -> ZenohBus:
        """The same that lets in who shows a certificate of its authority, with the rights in `access` (see there)."""
        bus = cls(_open(zenoh_settings.secured_router(endpoint, identity, access), endpoint), routes=True)
        bus.serve(keys.admission(), confirm_rights)
        return bus

    def publisher(self, topic: Topic) -> Publisher:
        control = zenoh.CongestionControl.BLOCK if topic.must_arrive else zenoh.CongestionControl.DROP
        priority = _PRIORITY[topic.priority]
        if topic.kept:
            recoverable = zenoh.ext.declare_advanced_publisher(
                self._session,
                topic.key,
                congestion_control=control,
                priority=priority,
                express=topic.express,
                cache=zenoh.ext.CacheConfig(topic.kept),
                sample_miss_detection=zenoh.ext.MissDetectionConfig(
                    heartbeat=_HEARTBEAT_S, sporadic_heartbeat=None
                ),
            )
            return _ZenohPublisher(recoverable)
        return _ZenohPublisher(
            self._session.declare_publisher(
                topic.key, congestion_control=control, priority=priority, express=topic.express
            )
        )

    def subscribe(self, key_expression: str, handler: Handler, *, recover: bool = False) -> Closable:
        def deliver(sample: zenoh.Sample) -> None:
            handler(Sample(str(sample.key_expr), sample.payload.to_bytes()))

        if recover:
            recovery = zenoh.ext.RecoveryConfig(periodic_queries=None, heartbeat=True)
            history = zenoh.ext.HistoryConfig(max_age=_ASKED_BACK_S)
            return self._keep(
                zenoh.ext.declare_advanced_subscriber(
                    self._session, key_expression, log_failures(deliver), recovery=recovery, history=history
                )
            )
        return self._keep(self._session.declare_subscriber(key_expression, log_failures(deliver)))

    def serve(self, topic: Topic, handler: RequestHandler) -> Closable:
        repetitions = Repetitions()

        def deliver(query: zenoh.Query) -> None:
            request = repetitions.ask(
                _bytes(query.attachment), str(query.key_expr), _bytes(query.payload), _ZenohAsker(query)
            )
            if request is not None:
                handler(request)

        return self._keep(self._session.declare_queryable(topic.key, log_failures(deliver)))

    def query(self, topic: Topic, payload: bytes, timeout_s: float) -> bytes:
        until_s = clock.monotonic_s() + timeout_s
        rest_s = _FIRST_REST_S
        request_id = uuid4().bytes
        while (left_s := until_s - clock.monotonic_s()) > 0.0:
            answer = self._ask(topic, payload, left_s, request_id)
            if answer is not None:
                return answer
            # Nobody serves it yet, or the link to whoever does was just lost: it is back within the time, or not.
            self._wait_for_service(topic, until_s)
            clock.sleep_s(min(rest_s, until_s - clock.monotonic_s()))
            rest_s *= 2.0
        raise Unavailable(
            f"Nobody answered on {topic.key} within {timeout_s:g} s; is that service running? "
            "`mart doctor` tells."
        )

    def _ask(self, topic: Topic, payload: bytes, timeout_s: float, request_id: bytes) -> bytes | None:
        """None at once where the router knows nobody who serves this."""
        replies = self._session.get(
            topic.key,
            payload=payload,
            attachment=request_id,
            timeout=timeout_s,
            priority=_PRIORITY[topic.priority],
            express=topic.express,
        )
        return next((reply.ok.payload.to_bytes() for reply in replies if reply.ok is not None), None)

    def _wait_for_service(self, topic: Topic, until_s: float) -> None:
        """Until somebody serves this: what a service declares may reach the router after its liveliness did."""
        served = threading.Event()
        with self._session.declare_querier(topic.key) as querier:
            listener = querier.declare_matching_listener(
                lambda status: served.set() if status.matching else None
            )
            try:
                already: Any = querier.matching_status  # the stubs say bool, but it is a status
                if not already.matching:
                    served.wait(max(until_s - clock.monotonic_s(), 0.0))
            finally:
                listener.undeclare()

    def announce(self, alive_key: str) -> Closable:
        return self._keep(self._session.liveliness().declare_token(alive_key))

    def watch(self, alive_expression: str, handler: AliveHandler) -> Closable:
        present: set[str] = set()

        def deliver(sample: zenoh.Sample) -> None:
            key, alive = str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT
            if alive == (key in present):
                return  # a token declared while we subscribe comes twice: as history and as news
            (present.add if alive else present.discard)(key)
            handler(key, alive)

        watch = self._keep(
            self._session.liveliness().declare_subscriber(
                alive_expression, log_failures(deliver), history=True
            )
        )
        self._watched[watch] = present
        return watch

    def alive(self, alive_expression: str, timeout_s: float = 1.0) -> list[str]:
        # A session answers for what it watches from its own memory, and now and then after it was told that the answer
        # is complete (Zenoh 1.10.2: `send_current_tokens` sends without the tables' lock): such keys were left out of
        # one answer in a thousand.
        was_linked = self._is_linked()
        found = set(self._tokens(alive_expression, timeout_s)) | self._watched_alive(alive_expression)
        if not found and not (was_linked and self._is_linked()):  # without a link nobody is found, at once
            raise Unavailable("The router is away, so nobody can say who is alive; see `mart doctor`.")
        return sorted(found)

    def _watched_alive(self, alive_expression: str) -> set[str]:
        expression = zenoh.KeyExpr(alive_expression)
        present: set[str] = set().union(*(keys.copy() for keys in list(self._watched.values())))
        return {key for key in present if expression.includes(zenoh.KeyExpr(key))}

    def _tokens(self, alive_expression: str, timeout_s: float) -> Iterator[str]:
        for reply in self._session.liveliness().get(alive_expression, timeout=timeout_s):
            if reply.ok is None:
                raise Unavailable(
                    f"The router did not say within {timeout_s:g} s who is alive; see `mart doctor`."
                )
            yield str(reply.ok.key_expr)

    def close(self) -> None:
        for declared in list(self._declared):
            declared.close()
        self._session.close()

    def _is_linked(self) -> bool:
        return self._routes or bool(self._session.info.routers_zid())

    def _keep(self, handle: Any) -> _Declared:
        declared = _Declared(handle, self._forget)
        self._declared.add(declared)
        return declared

    def _forget(self, declared: _Declared) -> None:
        self._declared.discard(declared)
        self._watched.pop(declared, None)


class _ZenohPublisher:
    def __init__(self, publisher: zenoh.Publisher | zenoh.ext.AdvancedPublisher) -> None:
        self._publisher = publisher

    def put(self, payload: bytes) -> None:
        self._publisher.put(payload)

    def close(self) -> None:
        self._publisher.undeclare()  # type: ignore[no-untyped-call]  # of the advanced one


class _ZenohAsker:
    def __init__(self, query: zenoh.Query) -> None:
        self._query = query

    def answer(self, payload: bytes) -> None:
        self._query.reply(self._query.key_expr, payload)
        self._query.drop()


class _Declared:
    """Undeclares explicitly: leaving it to the garbage collector has deadlocked (zenoh-python #434)."""

    def __init__(self, handle: Any, forget: Callable[[_Declared], None]) -> None:
        self._handle = handle
        self._forget = forget

    def close(self) -> None:
        self._forget(self)
        with contextlib.suppress(zenoh.ZError):  # closed before
            self._handle.undeclare()


def _opens(endpoint: str, shown: Settings) -> bool:
    """Try once to open a session with this secret or certificate, and close it."""
    try:
        _open(zenoh_settings.one_try(endpoint) | shown, endpoint).close()
    except Unavailable:
        return False
    return True


def _open(settings: Settings, endpoint: str) -> zenoh.Session:
    config = zenoh.Config()
    for path, value in (zenoh_settings.COMMON | settings).items():
        config.insert_json5(path, json.dumps(value))
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        word = "listen at" if settings["mode"] == "router" else "reach a router at"
        reason = str(error).partition(" at /")[0]  # what follows is the place in Zenoh's own sources
        raise Unavailable(
            f"Could not {word} {endpoint}: {reason}. Set MART_ROUTER or see `mart doctor`."
        ) from error


def _bytes(sent: zenoh.ZBytes | None) -> bytes:
    return b"" if sent is None else sent.to_bytes()
