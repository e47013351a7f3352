from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.web.access.plain_http import is_plain_http, redirection

ASKED = b"GET /check?a=1 HTTP/1.1\r\nUser-Agent: x\r\nHost: 192.168.1.5:8443\r\nAccept: */*\r\n\r\n"


def test_http_is_told_the_address_with_https() -> None:
    assert is_plain_http(ASKED)
    assert b"Location: https://192.168.1.5:8443/check?a=1\r\n" in redirection(ASKED)


def test_tls_is_left_alone() -> None:
    assert not is_plain_http(b"\x16\x03\x01\x02\x00\x01")


@pytest.mark.parametrize("host", [b"a b", b"", b"a/b", b"a\r\nX: y", b"x" * 300])
def test_a_strange_host_is_led_nowhere(host: bytes) -> None:
    answer = redirection(b"GET / HTTP/1.1\r\nHost: " + host + b" \r\n\r\n")
    assert b"Location" not in answer or b"Location: https://a/\r\n" in answer
    assert b"X: y" not in answer


@given(st.binary(max_size=200))
def test_whatever_comes_the_answer_is_one_head(rest: bytes) -> None:
    head, _, body = redirection(b"GET /" + rest).partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 ")
    assert b"\r\n\r\n" not in body
