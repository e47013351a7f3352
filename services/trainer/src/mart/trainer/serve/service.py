"""Bring policies into seats in two ways: promoted ones wherever a seat names them, and one of one's own."""

from __future__ import annotations

import contextlib
import os
import secrets
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from mart.operators.claim import claimed_seats
from mart.operators.client import ProgramSeats, drive_claimed
from mart.operators.commander import SeatCommander
from mart.operators.driver import SeatDriver
from mart.operators.operator import Operator
from mart.operators.room_client import RoomClient
from mart.operators.time_limit import TimeLimitedOperator
from mart.protocol import keys
from mart.protocol.errors import NotFound
from mart.protocol.messages import Model, RoomStatus
from mart.protocol.received import decode_received
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus
from mart.runtime.service import running
from mart.trainer.models.policies.policy import pictures_of
from mart.trainer.serve.policy_operator import PolicyOperator, parts_of
from mart.trainer.serve.policy_seats import LoadPolicy, PromotedPolicies, commander_of
from mart.trainer.serve.settings import OperateSettings, PoliciesSettings

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy

_NICEST = 19
_TIME_LIMIT_S = 2.0  # for one tick, as of any program in a seat
_MODEL_TIMEOUT_S = 5.0


def serve_policies(settings: PoliciesSettings, loader: Callable[[], LoadPolicy]) -> None:
    """Run until the process is asked to stop. `loader` takes seconds: it is called in the background beforehand."""
    loading = ThreadPoolExecutor(1, "loading")
    promoted = PromotedPolicies(settings.policies_dir, _late(loader), loading)
    with (
        running(settings, ServiceKind.POLICIES, settings.id) as service,
        contextlib.closing(SeatDriver(service.bus, settings.room, promoted)) as driver,
    ):
        threading.Thread(target=_warm_up, args=(loader,), daemon=True).start()
        while not service.stop.is_set():
            driver.work()
    loading.shutdown(wait=False, cancel_futures=True)


def _late(loader: Callable[[], LoadPolicy]) -> LoadPolicy:
    def load(checkpoint: Path) -> Policy:
        return loader()(checkpoint)

    return load


def _warm_up(loader: Callable[[], LoadPolicy]) -> None:
    os.nice(_NICEST)  # of this thread alone, on Linux: the others start meanwhile
    loader()


def operate(
    settings: OperateSettings, load: LoadPolicy, seated: Callable[[str, tuple[str, ...]], None]
) -> None:
    """Drive until the process is asked to stop; `seated` is told the name and the arms.

    While a person has taken over it waits for the seat. An answer that takes longer than 2 s leaves it. Of a policy
    that drives several arms together some can be given: it acts for all, and commands those. Raises Conflict where
    somebody else sits there, or when the last seat has been given to another; NotFound where the policy does not drive
    such an arm, InvalidInput where it was not made for this room.
    """
    policy = load(settings.checkpoint)
    arms = _arms(policy, settings.arms)
    name = settings.name or settings.checkpoint.name
    holder_id = secrets.token_hex(16)
    called = f"operate-{secrets.token_hex(8)}"  # everybody sees it: another one
    with running(settings, ServiceKind.OPERATE, called) as service:
        model = _model(service.bus, settings.room) if pictures_of(policy) else None
        parts = [part for part in parts_of(policy) if set(part.arms) & set(arms)]
        operators = [TimeLimitedOperator(_operator(part, model), _TIME_LIMIT_S) for part in parts]
        for operator in operators:
            operator.prepare()

        def commanders(status: RoomStatus) -> list[SeatCommander]:
            return [commander_of(*one, status) for one in zip(parts, operators, strict=True)]

        with claimed_seats(RoomClient(service.bus, settings.room), arms, holder_id, name) as seats:
            program = ProgramSeats(seats, name, commanders)
            seated(name, arms)
            drive_claimed(SeatDriver(service.bus, settings.room, program), seats, settings.room, service.stop)


def _model(bus: Bus, room: str) -> Model:
    return decode_received(Model, bus.query(keys.model(room), b"", _MODEL_TIMEOUT_S))


def _operator(policy: Policy, model: Model | None) -> Operator:
    if model is None or not pictures_of(policy):
        return PolicyOperator(policy)
    from mart.trainer.serve.seeing_operator import SeeingOperator

    return SeeingOperator(policy, model)


def _arms(policy: Policy, asked: tuple[str, ...]) -> tuple[str, ...]:
    unknown = sorted(set(asked) - set(policy.arms))
    if unknown:
        raise NotFound.named("arm of this policy", unknown[0], policy.arms)
    return asked or policy.arms
