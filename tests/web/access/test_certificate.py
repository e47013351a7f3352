from __future__ import annotations

import datetime as dt
from pathlib import Path

from cryptography import x509

from mart.web.access.certificate import LIFETIME, RENEWED_BEFORE, ensure_certificate

NOW = dt.datetime(2026, 11, 22, tzinfo=dt.UTC)
NAMES = ("localhost", "127.0.0.1", "::1", "lab.example")


def loaded(folder: Path) -> x509.Certificate:
    return x509.load_pem_x509_certificate((folder / "site.crt").read_bytes())


def test_it_names_everything_the_site_is_called(tmp_path: Path) -> None:
    ensure_certificate(tmp_path, NAMES, NOW)
    names = loaded(tmp_path).extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert sorted(names.get_values_for_type(x509.DNSName)) == ["lab.example", "localhost"]
    assert sorted(map(str, names.get_values_for_type(x509.IPAddress))) == ["127.0.0.1", "::1"]


def test_it_vouches_for_nobody_else(tmp_path: Path) -> None:
    ensure_certificate(tmp_path, NAMES, NOW)
    assert not loaded(tmp_path).extensions.get_extension_for_class(x509.BasicConstraints).value.ca


def test_its_key_is_its_owners_alone(tmp_path: Path) -> None:
    certificate = ensure_certificate(tmp_path, NAMES, NOW)
    assert certificate.path.stat().st_mode & 0o777 == 0o600
    assert b"PRIVATE" not in (tmp_path / "site.crt").read_bytes()


def test_it_is_kept_while_it_serves(tmp_path: Path) -> None:
    first = ensure_certificate(tmp_path, NAMES, NOW)
    content = first.path.read_bytes()
    later = NOW + LIFETIME - RENEWED_BEFORE - dt.timedelta(days=1)
    assert ensure_certificate(tmp_path, NAMES[:2], later) == first
    assert first.path.read_bytes() == content


def test_it_is_renewed_before_it_ends(tmp_path: Path) -> None:
    first = ensure_certificate(tmp_path, NAMES, NOW)
    due = first.expires - RENEWED_BEFORE
    second = ensure_certificate(tmp_path, NAMES, due)
    assert second.expires > first.expires
    assert loaded(tmp_path).not_valid_before_utc <= due


def test_a_new_name_makes_a_new_one(tmp_path: Path) -> None:
    ensure_certificate(tmp_path, NAMES, NOW)
    serial = loaded(tmp_path).serial_number
    ensure_certificate(tmp_path, (*NAMES, "192.168.1.5"), NOW)
    assert loaded(tmp_path).serial_number != serial


def test_a_name_of_before_is_kept_so_that_coming_back_needs_no_other(tmp_path: Path) -> None:
    ensure_certificate(tmp_path, ("localhost", "192.168.1.5"), NOW)
    elsewhere = ensure_certificate(tmp_path, ("localhost", "10.0.0.9"), NOW)
    assert ensure_certificate(tmp_path, ("localhost", "192.168.1.5"), NOW) == elsewhere


def test_a_damaged_one_is_made_anew(tmp_path: Path) -> None:
    path = ensure_certificate(tmp_path, NAMES, NOW).path
    path.write_bytes(b"torn")
    ensure_certificate(tmp_path, NAMES, NOW)
    assert x509.load_pem_x509_certificate(path.read_bytes()) == loaded(tmp_path)
