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
from mart.operators.driver import SeatDriver
from mart.operators.room_client import RoomClient
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.service import running
from mart.trainer.serve.policy_operator import parts_of
from mart.trainer.serve.policy_seats import LoadPolicy, PromotedPolicies, policy_commanders
from mart.trainer.serve.settings import OperateSettings, PoliciesSettings

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy

_NICEST = 19


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

    While a person has taken over it waits for the seat. Raises Conflict where somebody else sits there, or when the
    last seat has been given to another; InvalidInput or NotFound where the policy cannot drive these arms.
    """
    policy = load(settings.checkpoint)
    arms = _arms(policy, settings.arms)
    name = settings.name or settings.checkpoint.name
    holder_id = secrets.token_hex(16)
    called = f"operate-{secrets.token_hex(8)}"  # everybody sees it: another one
    with (
        running(settings, ServiceKind.OPERATE, called) as service,
        claimed_seats(RoomClient(service.bus, settings.room), arms, holder_id, name) as seats,
    ):
        program = ProgramSeats(seats, name, lambda status: policy_commanders(policy, status))
        seated(name, arms)
        drive_claimed(SeatDriver(service.bus, settings.room, program), seats, settings.room, service.stop)


def _arms(policy: Policy, asked: tuple[str, ...]) -> tuple[str, ...]:
    unknown = sorted(set(asked) - set(policy.arms))
    if unknown:
        raise NotFound.named("arm of this policy", unknown[0], policy.arms)
    if asked and set(asked) != set(policy.arms) and len(parts_of(policy)) == 1:
        raise InvalidInput(
            f"{', '.join(asked)} was given, but this policy drives {', '.join(policy.arms)} together; give them all."
        )
    return asked or policy.arms
