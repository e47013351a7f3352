"""Bound where an offer may make this machine send to: each address it names gets several packets. Pure.

Browsers hide their addresses behind names of multicast DNS (draft-ietf-mmusic-mdns-ice-candidates). From another
network nobody answers for such a name, and looking one up takes a second to give up; what connects there is found
without it, because the browser reaches this machine first. So names are apart: nobody waits for them.
"""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass

MAX_CANDIDATES = 32  # a laptop with Wi-Fi, a cable, two VPNs and a relay names about 20
_FIRST_PORT = 1024  # below it are services that might answer
_LINE = "a=candidate:"
_END = "a=end-of-candidates"
_NAME_SUFFIX = ".local"


@dataclass(frozen=True)
class NamedCandidate:
    """Hold a candidate that has a name for an address: `line` is its SDP attribute's value, of a media section."""

    media_index: int
    line: str


def bounded_candidates(sdp: str) -> tuple[str, tuple[NamedCandidate, ...]]:
    """Return an offer with those of its candidates that have addresses, and those that have names.

    Candidates that no browser has are left out, and those beyond the first 32.
    """
    lines: list[str] = []
    named: list[NamedCandidate] = []
    kept, media_index = 0, -1
    for line in sdp.splitlines(keepends=True):
        media_index += line.startswith("m=")
        if line.startswith(_LINE):
            if kept >= MAX_CANDIDATES or not _is_usable(line):
                continue
            kept += 1
            if line.split()[4].endswith(_NAME_SUFFIX):
                named.append(NamedCandidate(media_index, line.removeprefix(_LINE).strip()))
                continue
        lines.append(line)
    if named:  # what is looked up comes later, and after the end none counts
        lines = [line for line in lines if not line.startswith(_END)]
    return "".join(lines), tuple(named)


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
        return fields[4].endswith(_NAME_SUFFIX) and len(fields) >= 8
    return not (address.is_multicast or address.is_unspecified or address.is_reserved)
