"""Ask a replica of the bus to step a recording again."""

from __future__ import annotations

from collections.abc import Callable

from mart.protocol import codec, keys
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import RolloutReply, RolloutRequest, raise_error
from mart.protocol.received import decode_received
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.alive_wait import await_alive
from mart.runtime.bus import Bus

_TIMEOUT_S = 20.0
_TIMEOUT_PER_TICK_S = 0.02
_PATIENCE_S = 5.0

# Of a request to step again or to compare. Raises errors of the tree; Unavailable where nobody can answer now.
AskReplica = Callable[[RolloutRequest], RolloutReply]


def replica(bus: Bus, name: str, patience_s: float = _PATIENCE_S) -> AskReplica:
    """Ask the replica called `name`. Raises Unavailable, at once where there was none, or where it does not answer.

    One that was there is awaited for `patience_s`, as is a router that is away: one that is started anew forgets for
    about 2 s who is alive.
    """
    token = keys.alive(ServiceKind.REPLICA, name)
    was_up = False

    def ask(request: RolloutRequest) -> RolloutReply:
        nonlocal was_up
        try:
            is_up = bool(bus.alive(token))
            is_known = is_up or not was_up
        except Unavailable:
            is_up = is_known = False
        if not is_known:
            is_up = token in await_alive(bus, token, {token}, patience_s)
        was_up = is_up
        if not is_up:
            raise Unavailable(f"No replica {name!r} is up; start one with `mart replica --name {name}`.")
        timeout_s = _TIMEOUT_S + _TIMEOUT_PER_TICK_S * _ticks(request)
        reply = decode_received(RolloutReply, bus.query(keys.rollout(name), codec.encode(request), timeout_s))
        raise_error(reply.error)
        return reply

    return ask


def nobody(why: MartError) -> AskReplica:
    """Stand in where no replica can be asked: the function raises why."""

    def ask(_request: RolloutRequest) -> RolloutReply:
        raise why

    return ask


def _ticks(request: RolloutRequest) -> int:
    asked = request.compare_ticks if request.HasField("compare_ticks") else request.resimulate
    return len(asked.actions) // (8 * ACTION_SIZE * max(asked.arms, 1))
