"""Carry packets between two TUN devices, each when it is due, until told to stop; do what control messages ask."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import heapq
import json
import os
import select
import socket
from dataclasses import asdict
from typing import Any

from mart.protocol import clock
from mart.protocol.errors import InvalidInput
from tools.netrelay.impairment import PROFILES, LinkProfile
from tools.netrelay.packet_scheduler import PacketLoss, PacketScheduler
from tools.netrelay.traffic import Traffic
from tools.netrelay.tun_link import TunLink

_LONGEST_REST_S = 0.2  # a signal is seen after that long at most
_BATCH = 64  # packets that are read from one device before due ones are written
_PR_SET_TIMERSLACK = 29


class _Direction:
    def __init__(self, scheduler: PacketScheduler, target: int, destination: str) -> None:
        self.scheduler, self.target = scheduler, target
        self.destination = socket.inet_aton(
            destination
        )  # the only one whose packets pass: nothing leaves this machine
        self.traffic = Traffic()


class Relay:
    """Read, delay, lose and write. `stopped` ends it."""

    def __init__(self, link: TunLink, profile: LinkProfile, seed: int) -> None:
        """Carry packets over `link` as `profile` says, with losses and jitter of `seed`."""
        began_ns = clock.monotonic_ns()
        up = _Direction(PacketScheduler(profile.up, seed, began_ns), link.near, link.near_address)
        down = _Direction(PacketScheduler(profile.down, seed + 1, began_ns), link.far, link.far_address)
        self._sides = {"up": up, "down": down}
        self._by_source = {link.far: up, link.near: down}
        self._waiting: list[tuple[int, int, int, _Direction, bytes]] = []
        self._number = 0
        self.stopped = False

    def run(self, control: socket.socket) -> None:
        """Carry packets until `stopped`."""
        _be_punctual()
        sources = [*self._by_source, control.fileno()]
        while not self.stopped:
            for source in select.select(sources, (), (), self._rest_s())[0]:
                if source == control.fileno():
                    self._answer(control)
                else:
                    self._take(source, self._by_source[source])
            self._write_due()

    def summary(self) -> dict[str, Any]:
        """Return what each direction is set to, and what has passed since the last summary."""
        told = {
            side: direction.traffic.summary() | {"impairment": asdict(direction.scheduler.impairment)}
            for side, direction in self._sides.items()
        }
        for direction in self._sides.values():
            direction.traffic = Traffic()
        return told

    def change(self, wanted: dict[str, Any]) -> None:
        """Do what a control message asks; raises InvalidInput for what cannot be."""
        sides = {side: direction.scheduler for side, direction in self._sides.items()}
        now = LinkProfile(sides["up"].impairment, sides["down"].impairment)
        profile = PROFILES[wanted["profile"]] if wanted.get("profile") else now
        profile = profile.changed(wanted.get("settings", ()))
        sides["up"].impairment, sides["down"].impairment = profile.up, profile.down
        for side, scheduler in sides.items():
            if wanted.get("side") in (None, side):
                scheduler.interrupt(
                    clock.monotonic_ns(),
                    outage_s=wanted.get("outage_s", 0.0),
                    stall_s=wanted.get("stall_s", 0.0),
                )

    def _rest_s(self) -> float:
        if not self._waiting:
            return _LONGEST_REST_S
        return min(_LONGEST_REST_S, max(0.0, (self._waiting[0][0] - clock.monotonic_ns()) / 1e9))

    def _take(self, source: int, direction: _Direction) -> None:
        for _ in range(_BATCH):
            try:
                packet = os.read(source, 65_536)
            except BlockingIOError:
                return
            if packet[16:20] != direction.destination or packet[0] >> 4 != 4:
                continue
            now_ns = clock.monotonic_ns()
            direction.traffic.taken += 1
            arrives = direction.scheduler.schedule(now_ns, len(packet))
            if isinstance(arrives, PacketLoss):
                direction.traffic.lost[arrives] += 1
                continue
            self._number += 1
            heapq.heappush(self._waiting, (arrives, self._number, now_ns, direction, packet))

    def _write_due(self) -> None:
        while self._waiting and self._waiting[0][0] <= clock.monotonic_ns():
            due_ns, _, taken_ns, direction, packet = heapq.heappop(self._waiting)
            with contextlib.suppress(OSError):  # the device is down or full: lost, as on a wire
                os.write(direction.target, packet)
            now_ns = clock.monotonic_ns()
            direction.traffic.on_written(len(packet), now_ns - due_ns, now_ns - taken_ns)

    def _answer(self, control: socket.socket) -> None:
        request, sender = control.recvfrom(65_536)
        try:
            self.change(json.loads(request))
            answer = self.summary()
        except (InvalidInput, ValueError, KeyError, TypeError) as error:
            answer = {"error": str(error)}
        with contextlib.suppress(OSError):  # whoever asked has gone
            control.sendto(json.dumps(answer).encode(), sender)


def _be_punctual() -> None:
    """Wait to the microsecond, go first where that is allowed, and collect no garbage, of which there is none."""
    gc.disable()
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(_PR_SET_TIMERSLACK, 1)  # ns
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(10))
