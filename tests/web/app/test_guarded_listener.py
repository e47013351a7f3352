"""Real connections on this machine's loopback against a real server."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import socket
from collections.abc import AsyncIterator, Callable

import pytest
import uvicorn
from starlette.types import ASGIApp, Receive, Scope, Send

from mart.web.access import connection_table
from mart.web.access.connection_table import ConnectionTable
from mart.web.app import guarded_listener
from mart.web.app.guarded_listener import ConnectionMiddleware, GuardedListener, quiet_when_full
from mart.web.app.server import listen

pytestmark = pytest.mark.anyio

ASKED = b"GET / HTTP/1.1\r\nHost: x\r\n\r\n"
Stream = tuple[asyncio.StreamReader, asyncio.StreamWriter]


async def greet(_scope: Scope, _receive: Receive, send: Send) -> None:
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"2")]})
    await send({"type": "http.response.body", "body": b"hi"})


async def pour(_scope: Scope, _receive: Receive, send: Send) -> None:
    await send({"type": "http.response.start", "status": 200, "headers": []})
    while True:
        await send({"type": "http.response.body", "body": bytes(1_000_000), "more_body": True})


@contextlib.asynccontextmanager
async def served(table: ConnectionTable, application: ASGIApp = greet) -> AsyncIterator[int]:
    listener = GuardedListener(listen("127.0.0.1", 0), table)
    port = listener.getsockname()[1]
    app = ConnectionMiddleware(application, table)
    server = uvicorn.Server(
        uvicorn.Config(app, lifespan="off", log_config=None, proxy_headers=False, timeout_graceful_shutdown=1)
    )
    serving = asyncio.ensure_future(server._serve([listener]))
    ending = asyncio.ensure_future(listener.keep_ending())
    try:
        yield port
    finally:
        ending.cancel()
        server.should_exit = True
        await serving


async def connect(port: int, exits: contextlib.AsyncExitStack) -> Stream:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    exits.callback(writer.close)
    return reader, writer


async def until(holds: Callable[[], bool]) -> None:
    """The table is pure and tells nobody of a change, so it is looked at."""
    for _ in range(1500):
        if holds():
            return
        await asyncio.sleep(0.02)
    raise AssertionError


async def ask(stream: Stream) -> bytes:
    stream[1].write(ASKED)
    return (await asyncio.wait_for(stream[0].readuntil(b"hi"), 30)).splitlines()[0]


async def test_connections_that_ask_nothing_keep_nobody_out() -> None:
    table = ConnectionTable(per_address=8, in_all=100)
    async with served(table) as port, contextlib.AsyncExitStack() as exits:
        silent = [await connect(port, exits) for _ in range(40)]
        for _ in range(3):
            assert await ask(await connect(port, exits)) == b"HTTP/1.1 200 OK"
        assert await asyncio.wait_for(silent[0][0].read(), 30) == b""
        assert len(table) <= 8


async def test_one_that_never_asks_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection_table, "SILENT_S", 0.05)
    monkeypatch.setattr(guarded_listener, "_LOOK_EVERY_S", 0.05)
    table = ConnectionTable(per_address=8, in_all=100)
    async with served(table) as port, contextlib.AsyncExitStack() as exits:
        silent = await connect(port, exits)
        half = await connect(port, exits)
        half[1].write(b"GET / HTTP/1.1\r\nHost: x\r\nX-Slow: ")
        for reader, _writer in (silent, half):
            assert await asyncio.wait_for(reader.read(), 30) == b""
        assert len(table) == 0


async def test_one_that_takes_nothing_of_its_answer_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection_table, "SILENT_S", 0.05)
    monkeypatch.setattr(guarded_listener, "_LOOK_EVERY_S", 0.05)
    monkeypatch.setattr(guarded_listener, "TAKEN_WITHIN_S", 0.2)
    table = ConnectionTable(per_address=8, in_all=100)
    async with served(table, pour) as port, contextlib.AsyncExitStack() as exits:
        deaf = socket.create_connection(("127.0.0.1", port), 30)
        exits.callback(deaf.close)
        deaf.sendall(ASKED)
        await until(lambda: bool(table.overdue(1e12)))  # it was seen to ask nothing any more
        await until(lambda: not len(table))


async def test_what_has_ended_counts_no_more() -> None:
    table = ConnectionTable(per_address=8, in_all=100)
    async with served(table) as port:
        for _ in range(20):
            async with contextlib.AsyncExitStack() as exits:
                assert await ask(await connect(port, exits)) == b"HTTP/1.1 200 OK"
    assert len(table) == 0


async def test_connections_that_cannot_be_accepted_cost_a_line_a_minute(
    caplog: pytest.LogCaptureFixture,
) -> None:
    quiet_when_full()
    error = OSError(errno.EMFILE, "Too many open files")
    with caplog.at_level(logging.WARNING):
        for _ in range(5):
            asyncio.get_running_loop().call_exception_handler(
                {"message": "socket.accept()", "exception": error}
            )
    assert len(caplog.records) == 1
    assert caplog.records[0].exc_info is None


def test_a_listener_is_taken_over_and_closed() -> None:
    listener = listen("127.0.0.1", 0)
    guarded = GuardedListener(listener, ConnectionTable(1, 1))
    assert listener.fileno() == -1
    assert isinstance(guarded, socket.socket)
    guarded.close()


def test_the_second_piece_of_an_answer_waits_for_nothing() -> None:
    with (
        listen("127.0.0.1", 0) as listener,
        socket.create_connection(listener.getsockname()),
        contextlib.closing(listener.accept()[0]) as accepted,
    ):
        assert accepted.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
