from __future__ import annotations

from pathlib import Path

import click
import pytest

from mart.platform.run.invitation import in_words, qr_code, urls_for_others
from mart.platform.run.plan import PlatformOptions
from mart.runtime.ports import free_port

HOST = "HHHH-2345-6789"
HERE, LAN, NAMED = "https://localhost:8443/", "https://192.168.1.5:8443/", "https://mart.local:8443/"


def test_others_addresses_come_first_and_the_first_is_drawn() -> None:
    text = in_words(HERE, "ABCD-2345", [LAN, NAMED], host_code=HOST, with_picture=True)
    places = [text.index(word) for word in (LAN, NAMED, HERE, "ABCD-2345", HOST, "▀", "Ctrl-C")]
    assert places == sorted(places)
    assert click.unstyle(qr_code(f"{LAN}#code=ABCD-2345")) in click.unstyle(text)


@pytest.mark.parametrize(("others", "with_picture"), [([], True), ([LAN], False)])
def test_nothing_is_drawn_for_nobody_or_into_a_file(others: list[str], with_picture: bool) -> None:
    text = in_words(HERE, "ABCD-2345", others, host_code=HOST, with_picture=with_picture)
    assert "▀" not in text
    assert HERE in text
    assert f"Host code  {HOST}" in text


def test_a_public_name_is_not_said_twice() -> None:
    assert in_words(LAN, "ABCD-2345", [LAN], host_code=HOST, with_picture=False).count(LAN) == 1


def test_a_code_is_black_on_white_on_any_terminal() -> None:
    lines = qr_code("x").splitlines()
    assert len({len(click.unstyle(line)) for line in lines}) == 1
    assert all(click.style("", fg="bright_white", bg="black", reset=False) in line for line in lines)


def test_pages_that_do_not_answer_name_no_addresses() -> None:
    assert urls_for_others(PlatformOptions(Path("data"), port=free_port())) == []


@pytest.mark.parametrize(
    ("host", "public_host", "url", "local_url"),
    [
        ("127.0.0.1", "", HERE, HERE),
        ("0.0.0.0", "", HERE, HERE),
        ("::", "", HERE, HERE),
        ("192.168.1.5", "", LAN, LAN),
        ("0.0.0.0", "lab.example,localhost", "https://lab.example:8443/", HERE),
    ],
)
def test_every_address_is_no_address_to_go_to(host: str, public_host: str, url: str, local_url: str) -> None:
    options = PlatformOptions(Path("data"), host=host, public_host=public_host)
    assert (options.url, options.local_url) == (url, local_url)
