"""Join a seat over HTTPS, as a phone does: docs/protocol.md, "HTTP"."""

from __future__ import annotations

import contextlib
import ssl
from collections.abc import Awaitable, Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Self

import httpx

from mart.protocol.errors import Unavailable, from_wire

_TIMEOUT_S = 10.0


@dataclass(frozen=True)
class PhonePairing:
    """Hold the right to drive one arm with a phone."""

    token: str
    room: str
    arm: str
    epoch: int
    name: str


class PairingClient:
    """Ask the lobby, as a phone's page does, for the right to drive an arm and for connections."""

    def __init__(
        self, url: str, insecure: bool = False, transport: httpx.AsyncBaseTransport | None = None
    ) -> None:
        """Speak to the lobby at `url`; `insecure` takes any certificate, for one that a platform made for itself."""
        self._url = url.rstrip("/")
        verify: ssl.SSLContext | bool = False if insecure else ssl.create_default_context()
        origin = {"Origin": self._url}
        self._http = httpx.AsyncClient(verify=verify, timeout=_TIMEOUT_S, headers=origin, transport=transport)

    async def pair(self, code: str) -> PhonePairing:
        """Use up a pairing code; raises what the lobby answers, Unavailable where nobody does."""
        answer = await self._ask("POST", "/api/pair", {"code": code}, {})
        with self._complete():
            return PhonePairing(
                answer["token"], answer["room"], answer["arm"], int(answer["epoch"]), answer["name"]
            )

    async def renew(self, pairing: PhonePairing) -> PhonePairing:
        """Return the pairing for the seat as it is now, or for the one to which its person switched.

        Raises Conflict while they hold neither.
        """
        answer = await self._ask("GET", f"{_seat(pairing)}/phone-token", None, _bearer(pairing))
        with self._complete():
            arm = str(answer.get("arm", pairing.arm))  # lobbies of earlier versions say none
            return replace(pairing, arm=arm, token=answer["token"], epoch=int(answer["epoch"]))

    async def offer(self, pairing: PhonePairing, sdp: str) -> str:
        """Return the gateway's answer to an offer, both as SDP."""
        answer = await self._ask("POST", f"{_seat(pairing)}/offer", {"sdp": sdp}, _bearer(pairing))
        with self._complete():
            return str(answer["sdp"])

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self._http.aclose()

    async def _ask(
        self, method: str, path: str, body: dict[str, Any] | None, headers: dict[str, str]
    ) -> dict[str, Any]:
        with self._complete():
            response = await self._http.request(method, self._url + path, json=body, headers=headers)
            answer = response.json()
            if "error" in answer:
                raise from_wire(answer["error"]["code"], answer["error"]["message"])
            return dict(answer)

    @contextlib.contextmanager
    def _complete(self) -> Iterator[None]:
        """Raise Unavailable for whatever else than a lobby's answer came."""
        try:
            yield
        except (httpx.HTTPError, ValueError, TypeError, KeyError) as error:
            raise Unavailable(
                f"{self._url} does not answer as a lobby: {error!r}. Is `mart web` running?"
            ) from error


def exchange_of(
    lobby: PairingClient, pairing: PhonePairing, on_epoch: Callable[[int], None]
) -> Callable[[str], Awaitable[str]]:
    """Return how a paired phone connects: by a token for the seat as it is then, whose epoch `on_epoch` is told."""

    async def exchange(sdp: str) -> str:
        renewed = await lobby.renew(pairing)
        on_epoch(renewed.epoch)
        return await lobby.offer(renewed, sdp)

    return exchange


def _seat(pairing: PhonePairing) -> str:
    return f"/api/rooms/{pairing.room}/seats/{pairing.arm}"


def _bearer(pairing: PhonePairing) -> dict[str, str]:
    return {"Authorization": f"Bearer {pairing.token}"}
