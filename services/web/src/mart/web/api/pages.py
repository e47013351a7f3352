"""The pages themselves: static files, the same for everybody."""

from __future__ import annotations

from pathlib import Path

from fastapi import APIRouter
from fastapi.responses import FileResponse

router = APIRouter()

STATIC = Path(__file__).parent.parent / "static"


@router.get("/", include_in_schema=False)
async def lobby() -> FileResponse:
    return page("lobby")


@router.get("/rooms/{room}/arms/{arm}", include_in_schema=False)
async def operator(room: str, arm: str) -> FileResponse:
    return page("operator")


@router.get("/episodes", include_in_schema=False)
async def episodes() -> FileResponse:
    return page("episodes")


@router.get("/training", include_in_schema=False)
async def training() -> FileResponse:
    return page("training")


@router.get("/health", include_in_schema=False)
async def health() -> FileResponse:
    return page("health")


@router.get("/phone", include_in_schema=False)
async def phone() -> FileResponse:
    return page("phone")


def page(name: str, status: int = 200) -> FileResponse:
    return FileResponse(STATIC / f"{name}.html", status)
