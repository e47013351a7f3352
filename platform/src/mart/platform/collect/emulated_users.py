"""Emulated people: each holds a seat and leads its arm with an emulated phone, as a scripted expert intends.

Everything goes the way a person's does: HTTPS for the seat, WebRTC for the phone and, where a browser is given, the
picture. Only the brain is a script, which sees what that arm's operator sees.
"""

from __future__ import annotations

import contextlib
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mart.operators.room_watch import RoomWatch
from mart.platform.collect.browser import open_operator_page
from mart.platform.collect.web_client import WebClient
from mart.platform.run.identities import environment_of_kind
from mart.platform.run.running import Platform
from mart.protocol import clock
from mart.protocol.errors import Forbidden, Unavailable
from mart.protocol.messages import OPERATOR_POLICY, RoomStatus
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.child_process import MART, start_child, stop_child
from mart.runtime.skill_option import parse_people

if TYPE_CHECKING:
    from playwright.sync_api import Browser

_NAMES = ("Ana", "Ben", "Cleo", "Dan")
_SEAT_TIMEOUT_S = 60.0  # PyTorch takes seconds to load
_LOOK_EVERY_S = 0.2


@dataclass(frozen=True)
class EmulatedUser:
    arm: str
    name: str
    web_client: WebClient


@dataclass(frozen=True)
class EmulatedUsers:
    """Seat emulated people.

    skill: of all, or one for each of the task's arms (`mart.runtime.skill_option`). seed: each one's is this plus the
    seat's number.
    """

    platform: Platform
    skill: str
    seed: int
    browser: Browser | None = None

    @contextlib.contextmanager
    def seated(self, arms: Sequence[str]) -> Iterator[list[EmulatedUser]]:
        """One person per arm: phone paired and moving, page open where there is a browser."""
        with contextlib.ExitStack() as stack:
            yield [stack.enter_context(self._person(number, arm)) for number, arm in enumerate(arms)]

    @contextlib.contextmanager
    def beside(self, policies: Mapping[Path, Sequence[str]]) -> Iterator[None]:
        """Each of these checkpoints drives its arms. Raises Unavailable where one does not come to drive them."""
        with contextlib.ExitStack() as stack:
            for checkpoint, arms in policies.items():
                stack.enter_context(self._policy(checkpoint, arms))
            yield

    @contextlib.contextmanager
    def _policy(self, checkpoint: Path, arms: Sequence[str]) -> Iterator[None]:
        room, name = self.platform.options.room, f"policy-{arms[0]}"
        taken = [argument for arm in arms for argument in ("--arm", arm)]
        command = ["operate", "--checkpoint", str(checkpoint.resolve()), "--room", room, *taken]
        with (
            contextlib.closing(RoomWatch(self.platform.bus, room)) as watch,
            _running(self.platform, command, name) as process,
        ):
            deadline_s = clock.monotonic_s() + _SEAT_TIMEOUT_S
            while not _policies_drive(arms, watch.take(_LOOK_EVERY_S)[0].get(room)):
                if process.poll() is not None or clock.monotonic_s() > deadline_s:
                    log = self.platform.logs_dir / f"{name}.log"
                    raise Unavailable(f"{checkpoint} does not drive {', '.join(arms)}: {_last_line(log)}")
            yield

    @contextlib.contextmanager
    def _person(self, number: int, arm: str) -> Iterator[EmulatedUser]:
        platform, room = self.platform, self.platform.options.room
        task = get_task(platform.options.task)
        person = parse_people(self.skill, len(task.arms))[task.arm_names.index(arm)]
        name = person.name or _NAMES[number % len(_NAMES)]
        with contextlib.ExitStack() as stack:
            web_client = stack.enter_context(
                contextlib.closing(WebClient(platform.url, platform.certificate))
            )
            web_client.join(platform.join_code, name)
            web_client.take(room, arm)
            stack.callback(_leave, web_client, room, arm)
            if self.browser is not None:
                page = open_operator_page(self.browser, web_client, platform.seat_url(arm))
                stack.enter_context(contextlib.closing(page.context))
            seed = str(self.seed + number)
            brain = [
                "experts",
                "--room",
                room,
                "--arm",
                arm,
                "--intent",
                "--skill",
                person.skill,
                "--seed",
                seed,
            ]
            stack.enter_context(_running(platform, brain, f"brain-{arm}"))
            hand = ["phone", "--url", platform.url, "--code", web_client.pair(room, arm), "--insecure"]
            stack.enter_context(_running(platform, hand, f"phone-{arm}"))
            yield EmulatedUser(arm, name, web_client)


def _leave(web_client: WebClient, room: str, arm: str) -> None:
    with contextlib.suppress(Forbidden, Unavailable):  # handed back meanwhile, or the platform has gone
        web_client.leave(room, arm)


def _policies_drive(arms: Sequence[str], status: RoomStatus | None) -> bool:
    seats = status.seats if status is not None else ()
    return set(arms) <= {seat.arm for seat in seats if seat.operator == OPERATOR_POLICY}


def _last_line(log: Path) -> str:
    lines = log.read_text(errors="replace").splitlines()
    return lines[-1] if lines else f"{log} is empty."


@contextlib.contextmanager
def _running(platform: Platform, command: Sequence[str], name: str) -> Iterator[subprocess.Popen[bytes]]:
    with (platform.logs_dir / f"{name}.log").open("ab") as log:
        kind = ServiceKind(command[0])
        process = start_child([MART, *command], log, environment_of_kind(platform.options, kind))
    try:
        yield process
    finally:
        stop_child(process)
