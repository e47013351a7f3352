"""Addresses as pictures that a phone's camera reads."""

from __future__ import annotations

import segno


def qr_svg(url: str) -> str:
    """Return `url` as an `<svg>` element."""
    return segno.make(url, error="m", micro=False).svg_inline(dark="#000", light="#fff", border=3)
