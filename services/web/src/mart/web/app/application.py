"""The web application: a guard, the API, the pages, and one way in which errors become answers."""

from __future__ import annotations

import logging

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response
from starlette.exceptions import HTTPException

from mart.protocol.errors import InvalidInput, MartError, NotFound
from mart.web.api import (
    auth,
    datasets,
    device_check,
    episode_scenes,
    episodes,
    health,
    hosting,
    invitation,
    live,
    pages,
    phones,
    quality,
    rooms,
    scenes,
    signaling,
    training,
)
from mart.web.api.app_state import AppState
from mart.web.app.security_middleware import SecurityMiddleware
from mart.web.errors import TooMany, error_json, http_status

_log = logging.getLogger(__name__)


def create_app(state: AppState) -> FastAPI:
    """Return the ASGI application; `state` stays the caller's to close."""
    app = FastAPI(title="MART", openapi_url=None, docs_url=None, redoc_url=None)
    app.state.app_state = state
    app.add_middleware(SecurityMiddleware, site=state.site)
    for module in (
        auth,
        rooms,
        hosting,
        phones,
        signaling,
        scenes,
        device_check,
        invitation,
        live,
        health,
        episodes,
        quality,
        episode_scenes,
        datasets,
        training,
        pages,
    ):
        app.include_router(module.router)
    app.add_exception_handler(MartError, _on_mart_error)
    app.add_exception_handler(RequestValidationError, _on_bad_body)
    app.add_exception_handler(HTTPException, _on_http_error)
    app.add_exception_handler(Exception, _on_bug)
    return app


async def _on_mart_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, MartError)
    status = http_status(error)
    if status >= 500 or isinstance(error, TooMany):
        _log.warning("%s %s: %s", request.method, request.url.path, error)
    retry = {"Retry-After": f"{error.retry_s:.0f}"} if isinstance(error, TooMany) else None
    return JSONResponse(error_json(error), status, retry)


async def _on_bad_body(_request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    faults = "; ".join(f"{_place(fault['loc'])}: {fault['msg']}" for fault in error.errors())
    return JSONResponse(error_json(InvalidInput(f"This request cannot be used. {faults}.")), 400)


async def _on_http_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    if error.status_code == 404 and not request.url.path.startswith("/api/"):
        return pages.page("not-found", request, 404)
    kind = NotFound if error.status_code == 404 else InvalidInput
    sentence = (
        f"{request.method} {request.url.path} is not part of this API (docs/protocol.md): {error.detail}."
    )
    return JSONResponse(error_json(kind(sentence)), error.status_code)


async def _on_bug(_request: Request, _error: Exception) -> Response:
    """The server logs the traceback; whoever asked gets a sentence."""
    return JSONResponse(error_json(MartError("The web service failed at this; its log tells more.")), 500)


def _place(loc: tuple[int | str, ...]) -> str:
    return ".".join(str(part) for part in loc if part != "body") or "body"
