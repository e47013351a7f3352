"""Which services of a kind are asked: those that are alive, or are again in a moment."""

from __future__ import annotations

from mart.protocol import clock
from mart.protocol.vocabulary import ServiceKind
from mart.web.lobby.lobby import Lobby

# A link that broke on a busy machine is there again within a second; a router that is started anew knows of everybody
# after about two.
AWAY_S = 3.0


async def running_ids(lobby: Lobby, kind: ServiceKind) -> list[str]:
    """Return the ids of the services of `kind` that are alive, sorted.

    Where one was there and none is, it is awaited for `AWAY_S`; where none ever was, the empty list comes at once.
    """
    deadline_s = clock.monotonic_s() + AWAY_S
    with lobby.listeners.listen() as listener:
        while not (ids := lobby.services.ids(kind)) and lobby.services.were_seen(kind):
            left_s = deadline_s - clock.monotonic_s()
            if left_s <= 0.0:
                break
            await listener.wait(left_s)
    return ids
