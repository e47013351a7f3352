"""A platform's certificates: issued, followed, renewed, revoked; the ledger only ever grows."""

from __future__ import annotations

import datetime as dt
import multiprocessing
from pathlib import Path

import pytest

from mart.protocol.errors import Conflict, Forbidden, InvalidInput, NotFound
from mart.protocol.rights import BusPart
from mart.runtime.certificates.authority import LIFETIME, hosts_of, read_issued
from mart.runtime.certificates.identity import is_secured, read_identity
from mart.runtime.certificates.store import HERE, IDENTITY_FILE, ROUTER, CertificateStore

NOW = dt.datetime(2026, 12, 1, tzinfo=dt.UTC)


@pytest.fixture
def store(tmp_path: Path) -> CertificateStore:
    made = CertificateStore(tmp_path / "certificates")
    made.ensure(("localhost",), NOW)
    return made


def test_every_part_gets_one_and_it_can_be_shown(store: CertificateStore) -> None:
    for part in (ROUTER, *BusPart):
        identity = read_identity(store.folder / part, NOW)
        assert identity.common_name == f"{part}.here.1"
        assert identity.path.stat().st_mode & 0o077 == 0
    assert store.admitted(NOW) == {part: [f"{part}.here.1"] for part in BusPart}


def test_nothing_is_issued_twice(store: CertificateStore) -> None:
    before = store.ledger.read_bytes()
    store.ensure(("localhost",), NOW + LIFETIME - dt.timedelta(days=40))
    assert store.ledger.read_bytes() == before


def test_what_ends_soon_is_issued_anew_and_the_old_stays_good(store: CertificateStore) -> None:
    later = NOW + LIFETIME - dt.timedelta(days=20)
    store.ensure(("localhost",), later)
    assert store.admitted(later)[BusPart.SIM] == ["sim.here.1", "sim.here.2"]
    assert store.admitted(NOW + LIFETIME)[BusPart.SIM] == ["sim.here.2"]


def test_what_was_revoked_is_issued_anew(store: CertificateStore) -> None:
    assert [one.common_name for one in store.revoke("sim.here.1", NOW)] == ["sim.here.1"]
    assert store.admitted(NOW)[BusPart.SIM] == []
    store.ensure(("localhost",), NOW)
    assert store.admitted(NOW)[BusPart.SIM] == ["sim.here.2"]


def test_a_lost_file_is_issued_anew(store: CertificateStore) -> None:
    (store.folder / BusPart.WEB / IDENTITY_FILE).unlink()
    store.ensure(("localhost",), NOW)
    assert read_identity(store.folder / BusPart.WEB, NOW).common_name == "web.here.2"


def test_a_router_on_another_network_gets_another_name(store: CertificateStore) -> None:
    store.ensure(("localhost", "10.0.0.7"), NOW)
    path = store.folder / ROUTER / IDENTITY_FILE
    assert hosts_of(read_issued(path.read_bytes(), "it").certificate) == {"localhost", "10.0.0.7"}
    store.ensure(("localhost",), NOW)
    assert sum(one.part == ROUTER for one in store.issued()) == 2


def test_another_machine_is_revoked_as_one(store: CertificateStore, tmp_path: Path) -> None:
    for part in (BusPart.GATEWAY, BusPart.SIM):
        store.issue(part, "lab-2", (), tmp_path / "lab-2", NOW)
    assert read_identity(tmp_path / "lab-2" / BusPart.SIM, NOW).common_name == "sim.lab-2.1"
    store.revoke("lab-2", NOW)
    assert store.admitted(NOW)[BusPart.GATEWAY] == ["gateway.here.1"]
    with pytest.raises(Conflict, match="revoked already"):
        store.revoke("lab-2", NOW)
    with pytest.raises(NotFound, match="Did you mean 'lab-2'"):
        store.revoke("lab2", NOW)


@pytest.mark.parametrize(("part", "holder"), [("sun", HERE), ("sim", "Lab 2"), ("sim", "../x"), ("sim", "")])
def test_parts_and_holders_that_cannot_be(store: CertificateStore, part: str, holder: str) -> None:
    with pytest.raises(InvalidInput):
        store.issue(part, holder, (), store.folder, NOW)


def test_torn_and_foreign_lines_of_the_ledger_hold_nothing_up(store: CertificateStore) -> None:
    with store.ledger.open("ab") as ledger:
        ledger.write(b'{"revoked": "nobody.here.1"}\n[1]\n{"issued": 7}\n{"revoked": "sim.he')
    store.issue(BusPart.SIM, HERE, (), store.folder, NOW)
    assert store.admitted(NOW)[BusPart.SIM] == ["sim.here.1", "sim.here.2"]


def _issue_some(folder: Path, out: Path) -> None:
    for _ in range(5):
        CertificateStore(folder).issue(BusPart.SIM, HERE, (), out, NOW)


def test_two_processes_at_once_issue_different_names(store: CertificateStore, tmp_path: Path) -> None:
    context = multiprocessing.get_context("spawn")
    both = [
        context.Process(target=_issue_some, args=(store.folder, tmp_path / f"out{number}"))
        for number in range(2)
    ]
    for process in both:
        process.start()
    for process in both:
        process.join()
        assert process.exitcode == 0
    names = [one.common_name for one in store.issued() if one.part == BusPart.SIM]
    assert sorted(names) == sorted(f"sim.here.{number}" for number in range(1, 12))


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        ("missing", "none can be read"),
        ("ended", "ended on"),
        ("early", "is this machine's clock right"),
        ("foreign", "was not issued by the authority beside it"),
        ("swapped", "is not its certificate's"),
        ("torn", "holds no certificate"),
    ],
)
def test_a_certificate_that_cannot_be_used_is_named(
    store: CertificateStore, tmp_path: Path, spoil: str, said: str
) -> None:
    folder, path = store.folder / BusPart.SIM, store.folder / BusPart.SIM / IDENTITY_FILE
    now = {"ended": NOW + LIFETIME, "early": NOW - dt.timedelta(days=1)}.get(spoil, NOW)
    if spoil == "missing":
        path.unlink()
    if spoil == "foreign":
        other = CertificateStore(tmp_path / "other")
        other.issue(BusPart.SIM, HERE, (), tmp_path, NOW)
        path.write_bytes((tmp_path / BusPart.SIM / IDENTITY_FILE).read_bytes())
    if spoil == "swapped":
        web = (store.folder / BusPart.WEB / IDENTITY_FILE).read_text()
        sim = path.read_text()
        begins = "-----BEGIN CERTIFICATE"
        path.write_text(web[: web.index(begins)] + sim[sim.index(begins) :])
    if spoil == "torn":
        path.write_bytes(path.read_bytes()[:300])
    with pytest.raises(Forbidden, match=said):
        read_identity(folder, now)


def test_only_tls_and_quic_ask_for_one() -> None:
    assert [is_secured(f"{way}/127.0.0.1:7447") for way in ("tcp", "tls", "quic")] == [False, True, True]
