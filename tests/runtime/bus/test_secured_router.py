"""A router with certificates, while it runs: who is refused, how that is said, who is revoked without a stop."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from mart.protocol import clock, keys
from mart.protocol.errors import Forbidden, Unavailable
from mart.protocol.keys import Priority, Topic
from mart.protocol.rights import BusPart
from mart.runtime.bus.access_control import access_control
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.certificates.authority import issue, read_issued
from mart.runtime.certificates.identity import read_identity
from mart.runtime.certificates.store import HERE, IDENTITY_FILE, ROUTER, CertificateStore
from mart.runtime.certificates.which_identity import now
from mart.runtime.ports import free_port
from mart.runtime.secured_router import serve_secured_router

pytestmark = pytest.mark.system  # real peers

_SOON_S = 20.0


@dataclass(frozen=True)
class Running:
    endpoint: str
    store: CertificateStore


@pytest.fixture
def running(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Running]:
    monkeypatch.setenv("MART_DATA_DIR", str(tmp_path / "mine"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    store, stop = CertificateStore(tmp_path / "theirs"), threading.Event()
    store.ensure(("localhost", "127.0.0.1"), now())
    endpoint = f"tls/127.0.0.1:{free_port()}"
    thread = threading.Thread(target=serve_secured_router, args=(endpoint, store, (), stop))
    thread.start()
    try:
        ZenohBus.connect(endpoint, True, store.folder / BusPart.TOOLS).close()
        yield Running(endpoint, store)
    finally:
        stop.set()
        thread.join()


def test_its_users_commands_find_their_certificate_by_the_address(running: Running) -> None:
    with ZenohBus.connect(running.endpoint, False) as bus:
        assert bus.alive(keys.EVERY_ALIVE) == ["mart/@live/router/router"]


def test_another_user_is_told_that_there_is_no_certificate(
    running: Running, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "another-users"))
    with pytest.raises(Forbidden, match=r"none can be read in .*mart certificates issue"):
        ZenohBus.connect(running.endpoint, False)


def test_another_platforms_certificate_is_refused_in_words(running: Running, tmp_path: Path) -> None:
    other = CertificateStore(tmp_path / "other")
    other.issue(BusPart.SIM, HERE, (), other.folder, now())
    for waits in (False, True):
        with pytest.raises(Forbidden, match="it is another platform's"):
            ZenohBus.connect(running.endpoint, waits, other.folder / BusPart.SIM)


def test_a_certificate_that_no_ledger_knows_has_no_rights(running: Running, tmp_path: Path) -> None:
    authority = read_issued((running.store.folder / "authority.pem").read_bytes(), "it")
    forged = running.store.folder / "forged"
    forged.mkdir()
    (forged / IDENTITY_FILE).write_bytes(issue(authority, "sim.nobody.1", (), now()).pem)
    (forged / "authority.crt").write_bytes(authority.certificate_pem)
    with pytest.raises(Forbidden, match="gives this certificate no rights"):
        ZenohBus.connect(running.endpoint, False, forged)


def test_a_router_at_another_name_is_not_believed(running: Running) -> None:
    elsewhere = f"tls/127.0.0.2:{free_port()}"
    router = read_identity(running.store.folder / ROUTER, now())
    with (
        ZenohBus.route_secured(elsewhere, router, access_control({})),
        pytest.raises(Forbidden, match="has other names than the one in its address"),
    ):
        ZenohBus.connect(elsewhere, False, running.store.folder / BusPart.SIM)


def test_where_nobody_listens_it_is_not_the_certificate(running: Running) -> None:
    with pytest.raises(Unavailable):
        ZenohBus.connect(f"tls/127.0.0.1:{free_port()}", False, running.store.folder / BusPart.SIM)


def test_the_revoked_are_out_and_the_others_go_on(running: Running, tmp_path: Path) -> None:
    store = running.store
    store.issue(BusPart.SIM, "lab-2", (), tmp_path / "lab-2", now())
    _eventually(lambda: ZenohBus.connect(running.endpoint, False, tmp_path / "lab-2" / "sim").close())
    heard: set[bytes] = set()
    state = Topic("mart/room-1/state", Priority.HIGH, must_arrive=True)
    with (
        ZenohBus.connect(running.endpoint, False, store.folder / BusPart.RECORDER) as recorder,
        ZenohBus.connect(running.endpoint, False, store.folder / BusPart.SIM) as ours,
        ZenohBus.connect(running.endpoint, False, tmp_path / "lab-2" / "sim") as theirs,
    ):
        recorder.subscribe(state.key, lambda sample: heard.add(sample.payload))
        said = {b"ours": ours.publisher(state), b"theirs": theirs.publisher(state)}

        def say_until(wanted: set[bytes]) -> None:
            deadline_s = clock.monotonic_s() + _SOON_S
            while not wanted <= heard and clock.monotonic_s() < deadline_s:
                for name, publisher in said.items():
                    publisher.put(name)
                clock.sleep_s(0.05)
            assert wanted <= heard

        say_until({b"ours", b"theirs"})
        store.revoke("lab-2", now())
        _refused(running.endpoint, tmp_path / "lab-2" / "sim")
        heard.clear()
        say_until({b"ours"})
        assert heard == {b"ours"}


def test_a_renewed_certificate_is_shown_beside_the_one_before(running: Running) -> None:
    store = running.store
    with ZenohBus.connect(running.endpoint, False, store.folder / BusPart.SIM) as before:
        store.issue(BusPart.SIM, HERE, (), store.folder, now())
        assert read_identity(store.folder / BusPart.SIM, now()).common_name == "sim.here.2"
        _eventually(lambda: ZenohBus.connect(running.endpoint, False, store.folder / BusPart.SIM).close())
        _eventually(lambda: before.query(keys.admission(), b"", 2.0))


def _eventually(does: Callable[[], object]) -> None:
    """Until the router has read its ledger, and is back, it may refuse."""
    deadline_s = clock.monotonic_s() + _SOON_S
    while True:
        try:
            does()
        except (Forbidden, Unavailable):
            if clock.monotonic_s() > deadline_s:
                raise
        else:
            return


def _refused(endpoint: str, folder: Path) -> None:
    deadline_s = clock.monotonic_s() + _SOON_S
    said = ""
    while not said and clock.monotonic_s() < deadline_s:
        try:
            ZenohBus.connect(endpoint, True, folder).close()
        except Forbidden as error:
            said = str(error)
    assert "gives this certificate no rights" in said
