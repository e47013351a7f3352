"""One person at the pages, without a screen: joins, takes a seat, pairs a phone, says ready, over HTTPS."""

from __future__ import annotations

import ssl
from pathlib import Path
from typing import Any

import httpx

from mart.protocol.errors import Unavailable, from_wire

_TIMEOUT_S = 15.0
_IDLE_S = 2.0  # the server ends idle connections after 5 s; a request must not meet that end


class WebClient:
    """A session at the lobby. `url` ends with '/'; `certificate` is the site's own, the only one trusted."""

    def __init__(self, url: str, certificate: Path) -> None:
        context = ssl.create_default_context(cafile=str(certificate))
        self._client = httpx.Client(
            base_url=url,
            verify=context,
            timeout=_TIMEOUT_S,
            limits=httpx.Limits(keepalive_expiry=_IDLE_S),
            headers={"Origin": url.rstrip("/")},
        )

    def join(self, code: str, name: str) -> None:
        self._request("POST", "api/join", {"code": code, "name": name})

    def rooms(self) -> list[dict[str, Any]]:
        rooms: list[dict[str, Any]] = self._request("GET", "api/rooms")["rooms"]
        return rooms

    def is_room_answering(self, room: str) -> bool:
        """False where the lobby shows the room as silent, or not at all."""
        return any(one["room"] == room and not one.get("stale", False) for one in self.rooms())

    def take(self, room: str, arm: str) -> None:
        self._request("POST", f"api/rooms/{room}/seats/{arm}", {"operator": "human"})

    def assign(self, room: str, arm: str, operator: str, policy: str = "") -> None:
        """Sets a seat that no person holds to script, hold or a promoted policy."""
        self._request("POST", f"api/rooms/{room}/seats/{arm}", {"operator": operator, "policy": policy})

    def hand_back(self, room: str, arm: str) -> None:
        """Hand the arm back to the machine from which this person took over."""
        self._request("POST", f"api/rooms/{room}/seats/{arm}/hand-back")

    def leave(self, room: str, arm: str) -> None:
        self._request("DELETE", f"api/rooms/{room}/seats/{arm}")

    def pair(self, room: str, arm: str) -> str:
        """A code for one phone; it works once."""
        code: str = self._request("POST", f"api/rooms/{room}/seats/{arm}/pair")["code"]
        return code

    def act(self, room: str, arm: str, action: str) -> None:
        """Say one thing about the episode: ready, unready, success, failure, discard or reset."""
        self._request("POST", f"api/rooms/{room}/episode", {"action": action, "arm": arm})

    def offer(self, room: str, arm: str, sdp: str) -> str:
        """Return the gateway's answer to the offer of a page, both as SDP."""
        answer: str = self._request("POST", f"api/rooms/{room}/seats/{arm}/offer", {"sdp": sdp})["sdp"]
        return answer

    def scene(self, room: str, arm: str) -> str:
        """Have the scene made that a page draws, and return its digest."""
        digest: str = self._request("GET", f"api/rooms/{room}/seats/{arm}/scene")["sha256"]
        return digest

    def open_room(self, task: str, control_hz: float) -> str:
        """Open another room; its name."""
        body = {"task": task, "control_hz": control_hz}
        room: str = self._request("POST", "api/rooms", body)["room"]
        return room

    def cookies(self) -> list[dict[str, str]]:
        """The session, for a browser that goes on with it."""
        return [
            {"name": cookie.name, "value": cookie.value or "", "url": str(self._client.base_url)}
            for cookie in self._client.cookies.jar
        ]

    def close(self) -> None:
        self._client.close()

    def _request(self, method: str, path: str, body: dict[str, Any] | None = None) -> dict[str, Any]:
        try:
            response = self._client.request(method, path, json=body)
        except httpx.HTTPError as error:
            raise Unavailable(
                f"{method} {self._client.base_url}{path} failed: {error}. Is the web service up?"
            ) from error
        answer: dict[str, Any] = response.json()
        if response.is_error:
            error_ = answer.get("error", {})
            raise from_wire(error_.get("code", ""), error_.get("message", response.text))
        return answer
