from __future__ import annotations

import ipaddress

import pytest

from mart.web.names import host_name, in_url, lan_addresses, site_names


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


def test_public_names_come_first_and_nothing_comes_twice() -> None:
    names = site_names(("Lab.example", "localhost"))
    assert names[:2] == ("lab.example", "localhost")
    assert len(names) == len(set(names))
    assert {"127.0.0.1", "::1"} < set(names)


def test_lan_addresses_are_addresses_that_others_can_use() -> None:
    for address in lan_addresses():
        parsed = ipaddress.IPv4Address(address)
        assert not parsed.is_loopback
        assert not parsed.is_link_local


def test_addresses_of_six_words_are_bracketed_in_urls() -> None:
    assert (in_url("::1"), in_url("localhost")) == ("[::1]", "localhost")
