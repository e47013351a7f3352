"""Jobs, runs and policies, asked of the trainer."""

from __future__ import annotations

from mart.protocol import keys
from mart.protocol.messages import TrainerReply, TrainerRequest
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.ask import ask_async
from mart.web.clients.service_client import ServiceClient

_TIMEOUT_S = 10.0
_MAX_REPLY_BYTES = 16 * 1024 * 1024


class TrainerClient(ServiceClient):
    """Requests to the trainer."""

    kind = ServiceKind.TRAINER
    absence = "No trainer is running; start one with `mart trainer`."

    async def ask(self, request: TrainerRequest) -> TrainerReply:
        """Return the trainer's answer; raises Unavailable where none runs, and what the trainer reports."""
        return await ask_async(
            self._bus,
            keys.training(await self._running_id()),
            request,
            TrainerReply,
            timeout_s=_TIMEOUT_S,
            limit_bytes=_MAX_REPLY_BYTES,
        )
