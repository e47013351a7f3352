"""Bound where an offer may make this machine send to: each address it names gets several packets. Pure."""

from __future__ import annotations

import ipaddress

MAX_CANDIDATES = 32  # a laptop with Wi-Fi, a cable, two VPNs and a relay names about 20
_FIRST_PORT = 1024  # below it are services that might answer
_LINE = "a=candidate:"


def bounded_candidates(sdp: str) -> str:
    """Return an offer without those of its candidates that no browser has, and without those beyond the first 32."""
    kept, lines = 0, []
    for line in sdp.splitlines(keepends=True):
        if line.startswith(_LINE):
            if kept >= MAX_CANDIDATES or not _is_usable(line):
                continue
            kept += 1
        lines.append(line)
    return "".join(lines)


def _is_usable(line: str) -> bool:
    """Tell whether a line names a UDP port of an ordinary address. A name (of multicast DNS) is as good as one."""
    fields = line.split()
    if len(fields) < 6 or fields[2].lower() != "udp" or not fields[5].isdecimal():
        return False
    if not _FIRST_PORT <= int(fields[5]) <= 65_535:
        return False
    try:
        address = ipaddress.ip_address(fields[4])
    except ValueError:
        return fields[4].endswith(".local")
    return not (address.is_multicast or address.is_unspecified or address.is_reserved)
