"""How others come in: the site's addresses, the join code, and both as a picture."""

from __future__ import annotations

from urllib.parse import quote

from fastapi import APIRouter, Request

from mart.web.access.join_code import watch_code_of
from mart.web.access.site_names import host_name, is_loopback
from mart.web.api.dependencies import App, JoinedUser
from mart.web.api.qr_codes import qr_svg
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api")

UNREACHABLE = (
    "This service listens on this computer alone, so no other device can reach it. Start it with --host 0.0.0.0, or "
    "tell it with --public-host the name that others should use."
)


@router.get("/invitation")
async def invitation(request: Request, app: App, _user: JoinedUser) -> Json:
    """Send whoever is in what to show to others."""
    host = app.site.for_others(request.headers["host"])
    url = f"https://{host}/#code={quote(app.join_code)}"
    return {
        "url": f"https://{host}/",
        "other_urls": [
            other for other in app.site.urls_for_others(request.headers["host"]) if host not in other
        ],
        "code": app.join_code,
        "qr_svg": qr_svg(url),
        "watch_url": f"https://{host}/watch#code={watch_code_of(app.join_code, app.secret)}",
        "hint": UNREACHABLE if is_loopback(host_name(host)) else "",
    }
