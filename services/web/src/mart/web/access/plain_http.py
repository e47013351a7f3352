"""What is answered to who speaks HTTP where HTTPS is spoken: the same address, with https. Pure."""

from __future__ import annotations

import re

_REQUEST = re.compile(
    rb"(?:GET|HEAD) (?P<path>/[\x21-\x7e]{0,1024}) HTTP/1\.[01]\r\n"
    rb"(?:[^\r\n]+\r\n){0,64}?[Hh]ost: *(?P<host>[A-Za-z0-9.:\[\]-]{1,255})\r\n"
)
_PLAIN = (b"GET ", b"HEAD ")


def is_plain_http(first: bytes) -> bool:
    """Whether the first bytes of a connection are those of an HTTP request; TLS begins with 0x16."""
    return first.startswith(_PLAIN)


def redirection(first: bytes) -> bytes:
    """Return the answer to the request that begins with `first`; it is not kept, as this site's ports may change."""
    request = _REQUEST.match(first)
    if request is None:
        text = b"This site speaks HTTPS only: write https:// before its address.\n"
        head = b"HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain\r\n"
        return head + b"Content-Length: %d\r\nConnection: close\r\n\r\n" % len(text) + text
    address = b"https://" + request["host"] + request["path"]
    head = b"HTTP/1.1 307 Temporary Redirect\r\nLocation: " + address + b"\r\nCache-Control: no-store\r\n"
    return head + b"Content-Length: 0\r\nConnection: close\r\n\r\n"
