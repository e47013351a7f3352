"""The pages themselves: static files, the same for everybody."""

from __future__ import annotations

from pathlib import Path

from fastapi import APIRouter
from fastapi.responses import FileResponse

router = APIRouter()

STATIC = Path(__file__).parent.parent / "static"


@router.get("/", include_in_schema=False)
async def lobby() -> FileResponse:
    """Send the lobby's page."""
    return page("lobby")


@router.get("/rooms/{room}/arms/{arm}", include_in_schema=False)
async def operator(room: str, arm: str) -> FileResponse:
    """Send the page of whoever drives or watches an arm."""
    return page("operator")


@router.get("/episodes", include_in_schema=False)
async def episodes() -> FileResponse:
    """Send the page of recorded episodes."""
    return page("episodes")


@router.get("/training", include_in_schema=False)
async def training() -> FileResponse:
    """Send the page of runs and policies."""
    return page("training")


@router.get("/health", include_in_schema=False)
async def health() -> FileResponse:
    """Send the page that tells what is wrong."""
    return page("health")


@router.get("/check", include_in_schema=False)
async def check() -> FileResponse:
    """Send the page that tells whether a device is ready for a session."""
    return page("check")


@router.get("/watch", include_in_schema=False)
async def watch() -> FileResponse:
    """Send the page of spectators."""
    return page("watch")


@router.get("/phone", include_in_schema=False)
async def phone() -> FileResponse:
    """Send the phone's page."""
    return page("phone")


def page(name: str, status: int = 200) -> FileResponse:
    """Return the page `name` with the HTTP status `status`."""
    return FileResponse(STATIC / f"{name}.html", status)
