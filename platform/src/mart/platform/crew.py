"""Emulated people: each holds a seat and leads its arm with an emulated phone, as a scripted expert intends.

Everything goes the way a person's does: HTTPS for the seat, WebRTC for the phone and, where a browser is given, the
picture. Only the brain is a script, which sees what that arm's operator sees.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mart.platform.browser import open_operator_page
from mart.platform.plan import environment
from mart.platform.supervise import Platform
from mart.platform.visitor import Visitor
from mart.protocol.errors import Forbidden

if TYPE_CHECKING:
    from playwright.sync_api import Browser

_MART = Path(sys.executable).with_name("mart")
_NAMES = ("Ana", "Ben", "Cleo", "Dan")
_STOP_TIMEOUT_S = 10.0


@dataclass(frozen=True)
class Person:
    arm: str
    name: str
    visitor: Visitor


@dataclass(frozen=True)
class Crew:
    """`skill` and `seed` are the scripts'; each person's seed is the crew's plus the number of the seat."""

    platform: Platform
    skill: str
    seed: int
    browser: Browser | None = None

    @contextlib.contextmanager
    def seated(self, arms: Sequence[str]) -> Iterator[list[Person]]:
        """One person per arm: phone paired and moving, page open where there is a browser."""
        with contextlib.ExitStack() as stack:
            yield [stack.enter_context(self._person(number, arm)) for number, arm in enumerate(arms)]

    @contextlib.contextmanager
    def _person(self, number: int, arm: str) -> Iterator[Person]:
        platform, room = self.platform, self.platform.options.room
        name = _NAMES[number % len(_NAMES)]
        with contextlib.ExitStack() as stack:
            visitor = stack.enter_context(contextlib.closing(Visitor(platform.url, platform.certificate)))
            visitor.join(platform.join_code, name)
            visitor.take(room, arm)
            stack.callback(_leave, visitor, room, arm)
            if self.browser is not None:
                page = open_operator_page(self.browser, visitor, platform.url, room, arm)
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
                self.skill,
                "--seed",
                seed,
            ]
            stack.enter_context(_running(platform, brain, f"brain-{arm}"))
            hand = ["phone", "--url", platform.url, "--code", visitor.pair(room, arm), "--insecure"]
            stack.enter_context(_running(platform, hand, f"phone-{arm}"))
            yield Person(arm, name, visitor)


def _leave(visitor: Visitor, room: str, arm: str) -> None:
    with contextlib.suppress(Forbidden):  # handed back meanwhile
        visitor.leave(room, arm)


@contextlib.contextmanager
def _running(platform: Platform, command: Sequence[str], name: str) -> Iterator[None]:
    with (platform.logs_dir / f"{name}.log").open("ab") as log:
        process = subprocess.Popen(  # noqa: S603 - our own command, from our own environment
            [str(_MART), *command],
            env={**os.environ, **environment(platform.options)},
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    try:
        yield
    finally:
        process.terminate()
        try:
            process.wait(_STOP_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
