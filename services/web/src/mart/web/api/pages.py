"""The pages themselves and the files that they are made of: the same for everybody."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from fastapi import APIRouter, Request
from fastapi.responses import Response

from mart.protocol.errors import NotFound
from mart.web.api.static_site import StaticFile, StaticSite

router = APIRouter()

STATIC = Path(__file__).parent.parent / "static"
_KEPT = "public, max-age=31536000, immutable"  # a year
_LEADS_TO = {"lobby": "operator"}  # whoever looks at one will want the other, and has time to fetch it


@cache
def site() -> StaticSite:
    """Return the files, read once."""
    return StaticSite.read(STATIC, _LEADS_TO)


@router.get("/", include_in_schema=False)
async def lobby(request: Request) -> Response:
    """Send the lobby's page."""
    return page("lobby", request)


@router.get("/rooms/{room}/arms/{arm}", include_in_schema=False)
async def operator(room: str, arm: str, request: Request) -> Response:
    """Send the page of whoever drives or watches an arm."""
    return page("operator", request)


@router.get("/episodes", include_in_schema=False)
async def episodes(request: Request) -> Response:
    """Send the page of recorded episodes."""
    return page("episodes", request)


@router.get("/quality", include_in_schema=False)
async def quality(request: Request) -> Response:
    """Send the page that compares how people and days have recorded."""
    return page("quality", request)


@router.get("/training", include_in_schema=False)
async def training(request: Request) -> Response:
    """Send the page of runs and policies."""
    return page("training", request)


@router.get("/health", include_in_schema=False)
async def health(request: Request) -> Response:
    """Send the page that tells what is wrong."""
    return page("health", request)


@router.get("/check", include_in_schema=False)
async def check(request: Request) -> Response:
    """Send the page that tells whether a device is ready for a session."""
    return page("check", request)


@router.get("/watch", include_in_schema=False)
async def watch(request: Request) -> Response:
    """Send the page of spectators."""
    return page("watch", request)


@router.get("/host", include_in_schema=False)
async def host(request: Request) -> Response:
    """Send the page of hosts, which asks for their code."""
    return page("host", request)


@router.get("/phone", include_in_schema=False)
async def phone(request: Request) -> Response:
    """Send the phone's page."""
    return page("phone", request)


@router.get("/static/{path:path}", include_in_schema=False)
async def static(path: str, request: Request) -> Response:
    """Send a file that pages are made of; browsers keep what is addressed by this version's digest."""
    found = site().find(path)
    if found is None:
        raise NotFound(f"There is no file /static/{path}.")
    file, kept = found
    return _answer(file, request, headers={"Cache-Control": _KEPT} if kept else {})


def page(name: str, request: Request, status: int = 200) -> Response:
    """Return the page `name` with the HTTP status `status`."""
    return _answer(site().page(name), request, status)


def _answer(
    file: StaticFile, request: Request, status: int = 200, headers: dict[str, str] | None = None
) -> Response:
    headers = dict(headers or {})
    content = file.content
    if file.packed is not None:
        headers["Vary"] = "Accept-Encoding"
        if "gzip" in request.headers.get("accept-encoding", ""):
            headers["Content-Encoding"] = "gzip"
            content = file.packed
    return Response(content, status, headers, media_type=file.media_type)
