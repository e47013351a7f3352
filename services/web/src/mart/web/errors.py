"""Branches of the error tree that only HTTP knows, and the status that each branch becomes."""

from __future__ import annotations

from mart.protocol.errors import Conflict, Forbidden, InvalidInput, MartError, NotFound, Unavailable


class NotJoined(Forbidden):
    """There is no session, or it has ended."""

    def __init__(self) -> None:
        super().__init__(
            "You have not joined yet, or your visit has ended; join in the lobby with the join code."
        )


class OnlyWatches(Forbidden):
    """A spectator asked for what those do who joined."""

    def __init__(self) -> None:
        super().__init__(
            "You came to watch; whoever wants to take part joins in the lobby with the join code."
        )


class NotHost(Forbidden):
    """Somebody asked for what hosts alone do."""

    def __init__(self) -> None:
        super().__init__(
            "Only a host does this; whoever runs the platform has the host code, which the page /host takes."
        )


class WrongOrigin(Forbidden):
    """The request was not sent by a page of this site."""

    def __init__(self, origin: str | None) -> None:
        given = f"came from {origin[:80]!r}" if origin else "did not say where it came from"
        super().__init__(f"This request {given}; only this site's own pages may ask for changes.")


class WrongHost(InvalidInput):
    """The site was addressed by a name that is not its own."""

    def __init__(self, host: str, names: tuple[str, ...]) -> None:
        super().__init__(
            f"This site was addressed as {host[:80]!r}; it is called {', '.join(names)}. "
            "Another name is added with --public-host."
        )


class TooLarge(InvalidInput):
    """The body of a request is too long, or does not say its length."""

    def __init__(self, limit_bytes: int) -> None:
        super().__init__(
            f"The request's body is too long, or does not say its length; at most {limit_bytes} bytes are allowed."
        )


class TooSlow(InvalidInput):
    """The body of a request did not come in time."""

    def __init__(self, timeout_s: float) -> None:
        super().__init__(f"The request's body did not come within {timeout_s:g} s; send it again.")


class TooMany(MartError):
    """Somebody asked too often; `retry_s`: seconds until they may again."""

    def __init__(self, what: str, retry_s: float) -> None:
        super().__init__(f"Too many {what} from here; try again in {retry_s:.0f} s.")
        self.retry_s = retry_s

    @property
    def code(self) -> str:
        """The branch's name, as sent on the wire."""
        return "TooMany"


_STATUS: tuple[tuple[type[MartError], int], ...] = (
    (NotJoined, 401),
    (TooLarge, 413),
    (TooSlow, 408),
    (TooMany, 429),
    (WrongHost, 421),
    (InvalidInput, 400),
    (Forbidden, 403),
    (NotFound, 404),
    (Conflict, 409),
    (Unavailable, 503),
)


def http_status(error: MartError) -> int:
    """Return the HTTP status that an error becomes."""
    return next((status for kind, status in _STATUS if isinstance(error, kind)), 500)


def error_json(error: MartError) -> dict[str, dict[str, str]]:
    """Return the body of an answer that reports an error."""
    return {"error": {"code": error.code, "message": str(error)}}
