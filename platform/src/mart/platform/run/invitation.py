"""What a host's terminal shows to whoever comes in: addresses, join code, and both as a picture for a camera."""

from __future__ import annotations

import io
import logging
from urllib.parse import quote

import click
import httpx
import segno

from mart.platform.run.plan import PlatformOptions

_ASK_TIMEOUT_S = 5.0


def urls_for_others(options: PlatformOptions) -> list[str]:
    """Ask the pages by which addresses other devices reach them; none where they do not, or do not answer."""
    logging.getLogger("httpx").setLevel(logging.WARNING)
    try:
        # Whose certificate it is does not matter: nothing secret is asked, and what is told is only shown.
        answer = httpx.get(f"{options.local_url}api/health", verify=False, timeout=_ASK_TIMEOUT_S)  # noqa: S501
        return [str(url) for url in answer.json().get("urls", [])]
    except (httpx.HTTPError, ValueError):
        return []


def in_words(url: str, join_code: str, others: list[str], *, host_code: str, with_picture: bool) -> str:
    """Return the text for people. `url`: of this machine; `others`: for other devices, of which the first is drawn.

    host_code: as it is to be shown, or where it is kept.
    """
    lines = [f"  Lobby      {(others or [url])[0]}", *(f"         or  {other}" for other in others[1:])]
    if others and url not in others:
        lines.append(f"  Here       {url}")
    lines += [
        f"  Join code  {join_code}",
        f"  Host code  {host_code}, for the page /host: keep it to yourself",
    ]
    picture = qr_code(f"{others[0]}#code={quote(join_code)}") if others and with_picture else ""
    return "\n".join(["", *lines, "", *([picture, ""] if picture else []), "Ctrl-C stops everything."])


def qr_code(text: str) -> str:
    """Return `text` as a QR code of half blocks, black on white whatever the terminal's colours are."""
    drawn = io.StringIO()
    segno.make(text, error="l", micro=False).terminal(drawn, border=2, compact=True)
    return "\n".join(
        f"  {click.style(line, fg='bright_white', bg='black')}" for line in drawn.getvalue().splitlines()
    )
