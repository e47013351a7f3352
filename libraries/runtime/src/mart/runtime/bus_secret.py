"""Find the secret of a router: it admits only processes that know it, which are those of the user who started it.

The secret is in a private file below the platform's data folder, or wherever MART_BUS_SECRET_FILE says. A router notes
where it listens in its user's own folder of state, so that this user's other programs find it from anywhere.
"""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable

from mart.protocol import clock
from mart.protocol.errors import Forbidden, InvalidInput, Unavailable
from mart.runtime.ports import is_listening
from mart.runtime.router_notes import note_path
from mart.runtime.secret_file import load_secret
from mart.runtime.settings import Settings

_log = logging.getLogger(__name__)

_TRY_EVERY_S = 0.1
_NO_ROUTER_AFTER_S = 1.0
_REFUSED_AFTER_S = 2.0  # a router that has just started may be another one than the note says
_REFUSAL_TAKES_S = 1.5  # at most, also on a busy machine


def admitted_with(
    endpoint: str, opens: Callable[[bytes | None], bool], *, wait_for_router: bool
) -> bytes | None:
    """Return the secret with which the router at `endpoint` admits us, None where it needs none.

    Each that is known is tried, and none at all: `opens` tries one, once. Zenoh does not say that it was refused; but
    where somebody listens, and every try ends at once, that is it. Raises Forbidden then, and Unavailable where no
    router answers and `wait_for_router` is False; else keeps trying.
    """
    began_s = clock.monotonic_s()
    refused_since_s: float | None = None
    is_told = False
    while True:
        refused = False
        for secret in (*known_secrets(endpoint).values(), None):
            tried_s = clock.monotonic_s()
            if opens(secret):
                return secret
            refused = clock.monotonic_s() - tried_s < _REFUSAL_TAKES_S
            if not refused:
                break  # it says nothing: no other secret helps
        now_s = clock.monotonic_s()
        refused_since_s = (refused_since_s or now_s) if refused and is_listening(endpoint) else None
        if refused_since_s is not None and now_s - refused_since_s >= _REFUSED_AFTER_S:
            raise Forbidden(why_refused(endpoint))
        if not wait_for_router and refused_since_s is None and now_s - began_s >= _NO_ROUTER_AFTER_S:
            raise Unavailable(
                f"Could not reach a router at {endpoint}. Set MART_ROUTER or see `mart doctor`."
            )
        if not is_told and refused_since_s is None and now_s - began_s >= _NO_ROUTER_AFTER_S:
            is_told = True
            _log.warning(
                "No router answers at %s yet; waiting for it. Start `mart run`, or set MART_ROUTER.", endpoint
            )
        clock.sleep_s(_TRY_EVERY_S)


def known_secrets(endpoint: str) -> dict[str, bytes]:
    """Return the secrets that the router at `endpoint` may have, by where each was found, the likeliest first."""
    settings = Settings()
    found: dict[str, bytes] = {}
    for path in (note_path(endpoint), settings.bus_secret_path):
        with contextlib.suppress(OSError, InvalidInput):  # told where no other one is right
            found.setdefault(str(path), load_secret(path))
    return found


def why_refused(endpoint: str) -> str:
    """Return what to tell somebody whom the router at `endpoint` does not admit."""
    path = Settings().bus_secret_path
    mend = (
        "Set MART_DATA_DIR to the data folder of the platform there, or MART_BUS_SECRET_FILE to its secret."
    )
    try:
        load_secret(path)
    except FileNotFoundError:
        what = f"there is none in {path}"
    except PermissionError:
        what = f"{path} is another user's"
    except (OSError, InvalidInput) as error:
        what = f"{path} cannot be used ({error})"
    else:
        return (
            f"The router at {endpoint} is another platform's: it does not know the secret in {path}. {mend}"
        )
    return f"The router at {endpoint} admits only who has its secret, and {what}. {mend}"
