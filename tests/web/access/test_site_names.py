from __future__ import annotations

import ipaddress

import pytest

from mart.runtime.lan_addresses import lan_addresses
from mart.web.access import site_names as module
from mart.web.access.site_names import SiteNames, host_name, in_url, site_names


@pytest.mark.parametrize(
    ("header", "name"),
    [
        ("localhost", "localhost"),
        ("LAB.example:8443", "lab.example"),
        ("127.0.0.1:1", "127.0.0.1"),
        ("[::1]:8443", "::1"),
        ("[::1]", "::1"),
        ("", ""),
    ],
)
def test_the_name_in_a_host_header(header: str, name: str) -> None:
    assert host_name(header) == name


def test_told_names_come_first_nothing_comes_twice_and_nothing_is_found_beside_them() -> None:
    names = site_names(("Lab.example", "localhost"), "0.0.0.0")
    assert names == ("lab.example", "localhost", "127.0.0.1", "::1")


def test_without_told_names_the_machine_goes_by_all_of_its_own() -> None:
    names = site_names((), "192.0.2.7")
    assert {"192.0.2.7", "localhost", *lan_addresses()} <= set(names)
    assert len(names) == len(set(names))


def test_lan_addresses_are_addresses_that_others_can_use() -> None:
    for address in lan_addresses():
        parsed = ipaddress.IPv4Address(address)
        assert not parsed.is_loopback
        assert not parsed.is_link_local


def test_addresses_of_six_words_are_bracketed_in_urls() -> None:
    assert (in_url("::1"), in_url("localhost")) == ("[::1]", "localhost")


def test_a_laptop_that_moves_to_another_network_is_called_by_its_new_address(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "lan_addresses", lambda: ("192.168.1.5",))
    site = SiteNames((), "0.0.0.0")
    assert "192.168.1.5" in site.names
    assert site.lan_host == "192.168.1.5"
    monkeypatch.setattr(module, "lan_addresses", lambda: ("10.0.0.9",))
    site.look()
    assert "10.0.0.9" in site.names
    assert site.lan_host == "10.0.0.9"


@pytest.mark.parametrize(
    ("public", "listening_at", "host"),
    [
        (("localhost", "lab.example"), "0.0.0.0", "lab.example"),
        (("localhost",), "0.0.0.0", ""),
        ((), "127.0.0.1", ""),
        ((), "192.0.2.7", "192.0.2.7"),
    ],
)
def test_what_a_phone_may_call_it(public: tuple[str, ...], listening_at: str, host: str) -> None:
    assert SiteNames(public, listening_at).lan_host == host
