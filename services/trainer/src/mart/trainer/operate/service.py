"""The two ways for a policy into a seat: promoted ones for every seat that names them, and one of one's own."""

from __future__ import annotations

import contextlib
import os
import secrets
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from mart.protocol import codec, keys
from mart.protocol.errors import Conflict, InvalidInput, MartError, NotFound
from mart.protocol.messages import OPERATOR_POLICY, RoomReply, Seat, SeatRequest, raise_error
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus
from mart.runtime.service import running
from mart.trainer.operate.crews import Crews, Load
from mart.trainer.operate.operator import parts_of
from mart.trainer.operate.settings import OperateSettings, PoliciesSettings

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy

_QUERY_TIMEOUT_S = 5.0
_NICEST = 19


def serve_policies(settings: PoliciesSettings, loader: Callable[[], Load]) -> None:
    """Until the process is asked to stop. `loader` takes seconds: it is called in the background, before its need."""

    def checkpoint_of(seat: Seat) -> Path | None:
        promoted = seat.operator == OPERATOR_POLICY and seat.policy
        return settings.policies_dir / seat.policy if promoted else None

    with (
        running(settings, ServiceKind.POLICIES, settings.id) as service,
        contextlib.closing(Crews(service.bus, settings.room, checkpoint_of, _late(loader))) as crews,
    ):
        threading.Thread(target=_warm_up, args=(loader,), daemon=True).start()
        while not service.stop.is_set():
            crews.work()


def _late(loader: Callable[[], Load]) -> Load:
    def load(checkpoint: Path) -> Policy:
        return loader()(checkpoint)

    return load


def _warm_up(loader: Callable[[], Load]) -> None:
    os.nice(_NICEST)  # of this thread alone, on Linux: the others start meanwhile
    loader()


def operate(settings: OperateSettings, load: Load, seated: Callable[[str, tuple[str, ...]], None]) -> None:
    """Drives until the process is asked to stop; `seated` is told the name and the arms.

    While a person has taken over it waits for the seat. Raises Conflict where somebody else sits there, or when the
    last seat has been given to another; InvalidInput or NotFound where the policy cannot drive these arms.
    """
    policy = load(settings.checkpoint)
    arms = _arms(policy, settings.arms)
    name = settings.name or settings.checkpoint.name
    holder_id = f"operate-{secrets.token_hex(8)}"
    with (
        running(settings, ServiceKind.OPERATE, holder_id) as service,
        _claimed(service.bus, settings.room, arms, holder_id, name) as seats,
    ):
        own = OwnSeats(settings.checkpoint, holder_id, seats)
        seated(name, arms)
        with contextlib.closing(Crews(service.bus, settings.room, own, load)) as crews:
            while not service.stop.is_set():
                crews.work()
                own.require_any(settings.room)


class OwnSeats:
    """Which seats of one holder are to be driven; a seat of which a person has relieved it may come back."""

    def __init__(self, checkpoint: Path, holder_id: str, claimed: list[Seat]) -> None:
        self._checkpoint, self._holder_id = checkpoint, holder_id
        self._claimed = {seat.arm: seat for seat in claimed}

    def __call__(self, seat: Seat) -> Path | None:
        claimed = self._claimed.get(seat.arm)
        if claimed is None:
            return None
        if seat.holder_id == self._holder_id:
            return self._checkpoint
        if seat.epoch > claimed.epoch and seat.relieved != claimed.name:
            del self._claimed[seat.arm]
        return None

    def require_any(self, room: str) -> None:
        """Raises Conflict where every seat has gone to somebody else for good."""
        if not self._claimed:
            raise Conflict(
                f"The seat in {room} was given away or left; seat the policy again when it is free."
            )


def _arms(policy: Policy, asked: tuple[str, ...]) -> tuple[str, ...]:
    unknown = sorted(set(asked) - set(policy.arms))
    if unknown:
        raise NotFound.named("arm of this policy", unknown[0], policy.arms)
    if asked and set(asked) != set(policy.arms) and len(parts_of(policy)) == 1:
        raise InvalidInput(
            f"{', '.join(asked)} was given, but this policy drives {', '.join(policy.arms)} together; give them all."
        )
    return asked or policy.arms


@contextlib.contextmanager
def _claimed(bus: Bus, room: str, arms: tuple[str, ...], holder_id: str, name: str) -> Iterator[list[Seat]]:
    """The seats are left when the block ends, those included that a person holds for the moment."""
    with contextlib.ExitStack() as stack:
        seats = []
        for arm in arms:
            claim = SeatRequest.Claim(arm=arm, holder_id=holder_id, name=name, operator=OPERATOR_POLICY)
            seats.append(_ask(bus, room, SeatRequest(claim=claim)).seat)
            stack.callback(_leave, bus, room, arm, holder_id)
        yield seats


def _leave(bus: Bus, room: str, arm: str, holder_id: str) -> None:
    release = SeatRequest.Release(arm=arm, holder_id=holder_id)
    with contextlib.suppress(MartError):  # it is another's by now, or the room is gone
        _ask(bus, room, SeatRequest(release=release))


def _ask(bus: Bus, room: str, request: SeatRequest) -> RoomReply:
    reply = codec.decode(RoomReply, bus.query(keys.seat(room), codec.encode(request), _QUERY_TIMEOUT_S))
    raise_error(reply.error)
    return reply
