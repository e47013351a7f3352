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
_FIRST_PATIENCE_S = 2.0

# Of a request to step again or to compare. Raises errors of the tree; Unavailable where nobody can answer now.
AskReplica = Callable[[RolloutRequest], RolloutReply]


def replica(bus: Bus, name: str, patience_s: float = _PATIENCE_S) -> AskReplica:
    """Ask the replica called `name`. Raises Unavailable where there is none, or where it does not answer.

    One that was there is awaited for `patience_s`, and at the first request for 2 s: a router that is started anew
    forgets for about 2 s who is alive. One that was away is not awaited again.
    """
    token = keys.alive(ServiceKind.REPLICA, name)
    awaited_s = min(patience_s, _FIRST_PATIENCE_S)

    def ask(request: RolloutRequest) -> RolloutReply:
        nonlocal awaited_s
        is_up = token in (await_alive(bus, token, {token}, awaited_s) if awaited_s else bus.alive(token))
        awaited_s = patience_s if is_up else 0.0
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
