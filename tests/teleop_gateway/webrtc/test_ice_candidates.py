from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.teleop_gateway.webrtc.ice_candidates import MAX_CANDIDATES, NamedCandidate, bounded_candidates

HEAD = "v=0\r\nm=application 9 UDP/DTLS/SCTP webrtc-datachannel\r\n"


def candidate(address: str = "192.168.1.7", port: int = 50_000, transport: str = "udp") -> str:
    return f"a=candidate:1 1 {transport} 2113937151 {address} {port} typ host generation 0\r\n"


@pytest.mark.parametrize(
    "line",
    [
        candidate(),
        candidate("2001:db8::7"),
        candidate("127.0.0.1"),
    ],
)
def test_what_browsers_name_is_kept(line: str) -> None:
    assert bounded_candidates(HEAD + line) == (HEAD + line, ())


def test_names_that_must_be_looked_up_are_apart() -> None:
    line = candidate("0c5c2a4d-1b0e-4a9e-9df4-0d3a3b1c2d3e.local")
    named = NamedCandidate(1, line.removeprefix("a=candidate:").strip())
    assert bounded_candidates(HEAD + HEAD + line + candidate()) == (HEAD + HEAD + candidate(), (named,))


@pytest.mark.parametrize(
    "line",
    [
        candidate(port=53),
        candidate(port=70_000),
        candidate("224.0.0.251"),
        candidate("255.255.255.255"),
        candidate("0.0.0.0"),
        candidate("victim.example"),
        candidate(transport="tcp"),
        "a=candidate:\r\n",
    ],
)
def test_what_no_browser_names_is_not_sent_to(line: str) -> None:
    assert bounded_candidates(HEAD + line) == (HEAD, ())


def test_an_offer_names_so_many_addresses_and_no_more() -> None:
    many = HEAD + "".join(candidate(f"10.0.{number}.1") for number in range(200))
    assert bounded_candidates(many)[0].count("a=candidate:") == MAX_CANDIDATES


@given(st.text())
def test_any_text_passes_whole_but_for_candidates(text: str) -> None:
    kept = [line for line in text.splitlines(keepends=True) if not line.startswith("a=candidate:")]
    assert bounded_candidates(text)[0] == "".join(kept)
