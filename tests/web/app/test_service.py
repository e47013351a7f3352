"""The real service: its own process, real TLS, a real bus, a real WebSocket."""

from __future__ import annotations

import contextlib
import json
import socket
import ssl
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from mart.protocol.messages import Event
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.support.processes import Running, running_router, running_service, started
from tests.web.room import Room, speaking

pytestmark = pytest.mark.system


@dataclass(frozen=True)
class Web:
    process: Running
    port: int
    endpoint: str
    data_dir: Path
    trust: ssl.SSLContext

    @property
    def live_trust(self) -> ssl.SSLContext:
        """For a socket that one thread reads while another writes.

        OpenSSL handles TLS 1.3's session tickets while it reads, so that a handshake of `websockets.sync` was lost
        4 times in 19,000; never in 22,000 with TLS 1.2.
        """
        trust = ssl.create_default_context(cafile=str(self.data_dir / "certificates" / "site.crt"))
        trust.maximum_version = ssl.TLSVersion.TLSv1_2
        return trust

    @property
    def origin(self) -> str:
        return f"https://localhost:{self.port}"

    @property
    def join_code(self) -> str:
        return (self.data_dir / "join-code").read_text().strip()

    def client(self) -> httpx.Client:
        return httpx.Client(base_url=self.origin, verify=self.trust, headers={"Origin": self.origin})

    @contextlib.contextmanager
    def joined(self, name: str) -> Iterator[httpx.Client]:
        with self.client() as client:
            assert client.post("/api/join", json={"code": self.join_code, "name": name}).status_code == 200
            yield client

    def live(self, client: httpx.Client, origin: str | None = None, after: object = None) -> ClientConnection:
        cookie = "; ".join(f"{cookie.name}={cookie.value}" for cookie in client.cookies.jar)
        return connect(
            f"wss://localhost:{self.port}/api/live" + ("" if after is None else f"?after={after}"),
            ssl=self.live_trust,
            origin=None if origin == "" else origin or self.origin,  # type: ignore[arg-type]
            additional_headers={"Cookie": cookie},
        )


@pytest.fixture(scope="module")
def web(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Web]:
    data_dir, port = tmp_path_factory.mktemp("web"), free_port()
    command = ["web", "--port", str(port)]
    with (
        running_router() as endpoint,
        running_service(command, endpoint, data_dir, kind="web", id="web") as process,
    ):
        trust = ssl.create_default_context(cafile=str(data_dir / "certificates" / "site.crt"))
        yield Web(process, port, endpoint, data_dir, trust)


@pytest.fixture
def room(web: Web) -> Iterator[Room]:
    with ZenohBus.connect(web.endpoint) as bus, contextlib.closing(Room(bus)) as room, speaking(room):
        yield room


def receive(live: ClientConnection, what: str) -> Any:
    while True:
        message = json.loads(live.recv(timeout=30))
        if message.get(what):
            return message[what]


def test_http_in_its_place_is_led_to_https(web: Web) -> None:
    answer = httpx.get(f"http://localhost:{web.port}/check")
    assert answer.status_code == 307
    assert answer.headers["location"] == f"{web.origin}/check"


def test_it_is_reached_over_https_with_the_certificate_it_made(web: Web) -> None:
    with web.client() as client:
        assert client.get("/api/health").json()["services"]["web"] == ["web"]


def test_the_join_code_is_where_others_find_it(web: Web) -> None:
    assert f"https://127.0.0.1:{web.port}/" in web.process.log()
    assert web.join_code not in web.process.log()  # a log is no place for it
    assert str(web.data_dir / "join-code") in web.process.log()
    host_code = (web.data_dir / "host-code").read_text().strip()
    assert host_code not in web.process.log()
    with web.joined("Hanna") as hanna:
        assert hanna.post("/api/host", json={"code": host_code}).json()["hosts"]


def test_what_it_keeps_is_its_owners_alone(web: Web) -> None:
    kept = list(web.data_dir.rglob("*"))
    assert {"host-code", "join-code", "sessions.sqlite", "site.pem"} <= {path.name for path in kept}
    assert [path for path in kept if path.stat().st_mode & 0o077 and path != web.process.log_path] == []


def test_the_live_socket_tells_rooms_and_events(web: Web, room: Room) -> None:
    with web.joined("Ana") as ana, web.live(ana) as live:
        assert receive(live, "rooms")[0]["room"] == "room-1"
        taken = ana.post("/api/rooms/room-1/seats/arm0", json={"operator": "human"})
        assert taken.status_code == 200
        while not receive(live, "rooms")[0]["seats"][0]["mine"]:
            pass
        event = Event()
        event.notice.text = "The disk is nearly full."
        room.tell(event)
        assert receive(live, "event")["text"] == "The disk is nearly full."
        live.send("whatever a page may say")
        assert receive(live, "rooms")


def test_a_page_that_comes_back_is_told_what_it_missed(web: Web, room: Room) -> None:
    def notice(text: str) -> Event:
        return Event(notice=Event.Notice(level="warning", text=text))

    with web.joined("Ana") as ana:
        with web.live(ana) as live:
            assert receive(live, "rooms")
            room.tell(notice("The disk is nearly full."))
            heard = receive(live, "event")
        with web.live(ana) as other:
            assert receive(other, "rooms")
            room.tell(notice("The disk is full."))
            missed = receive(other, "event")
        with web.live(ana, after=heard["id"]) as live:
            assert receive(live, "event") == missed


@pytest.mark.parametrize("after", ["x", "-1", str(2**63)])
def test_an_event_that_cannot_be_is_no_place_to_go_on_from(web: Web, after: str) -> None:
    with web.joined("Ana") as ana, pytest.raises(InvalidStatus, match="403"), web.live(ana, after=after):
        pass


@pytest.mark.parametrize("origin", ["https://evil.example", "https://localhost:1", ""])
def test_other_sites_cannot_listen(web: Web, origin: str) -> None:
    with web.joined("Ana") as ana, pytest.raises(InvalidStatus, match="403"), web.live(ana, origin):
        pass


def test_strangers_cannot_listen(web: Web) -> None:
    with web.client() as stranger, pytest.raises(InvalidStatus, match="403"), web.live(stranger):
        pass


def test_a_second_service_at_the_same_address_says_so(web: Web, tmp_path: Path) -> None:
    with started(["web", "--port", str(web.port)], web.endpoint, tmp_path) as second:
        assert second.process.wait(20) == 1
        assert f"port {web.port}" in second.log()
        assert "--port" in second.log()
        assert "Traceback" not in second.log()


def test_connections_that_ask_nothing_keep_nobody_out(web: Web) -> None:
    with contextlib.ExitStack() as silent:
        for _ in range(400):
            silent.enter_context(socket.create_connection(("127.0.0.1", web.port), 30))
        with web.client() as client:
            assert client.get("/api/health", timeout=30).status_code == 200
    assert "Traceback" not in web.process.log()


def test_a_restart_keeps_people_joined_and_ends_cleanly(tmp_path: Path) -> None:
    port = free_port()
    command = ["web", "--port", str(port)]
    with contextlib.ExitStack() as stack:
        endpoint = stack.enter_context(running_router())
        with running_service(command, endpoint, tmp_path, kind="web", id="web") as first:
            trust = ssl.create_default_context(cafile=str(tmp_path / "certificates" / "site.crt"))
            web = Web(first, port, endpoint, tmp_path, trust)
            ana = stack.enter_context(web.joined("Ana"))
            with web.live(ana) as live:
                live.recv(timeout=30)
                assert first.terminate() == 0
            assert "Traceback" not in first.log()
        with running_service(command, endpoint, tmp_path, kind="web", id="web"):
            assert ana.get("/api/me").json()["name"] == "Ana"
