"""Noise at a running platform, for as long as you like: `python -m tests.support.fuzz_bus --seconds 300`.

It speaks on every key and asks every question, as a defective process of our own could, with payloads that are
garbage, cut, flipped, or at the limits of their types. It says which services ended meanwhile and whether every room
goes on, and exits with 1 where one did not. Use a platform of its own: seats are taken, episodes begun, rooms opened.
"""

from __future__ import annotations

import contextlib
import json
import random
import sys
from collections import Counter, defaultdict, deque
from collections.abc import Callable
from functools import partial

import click

from mart.protocol import clock, codec, keys
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.keys import Topic
from mart.protocol.messages import RoomStatus
from mart.protocol.queryables import BROADCASTS, QUERYABLES
from mart.protocol.received import decode_received
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus, Publisher, Sample
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.settings import Settings
from tests.support.bus_noise import BusNoise

_KINDS = {
    "signal": None,  # of a room
    "seat": None,
    "episode": None,
    "rollout": ServiceKind.REPLICA,
    "open": ServiceKind.GATEWAY,
    "jobs": ServiceKind.TRAINER,
    "rooms": ServiceKind.PLATFORM,
    "catalogue": ServiceKind.CATALOGUE,
}
_ASK_TIMEOUT_S = 1.0
_SETTLE_S = 45.0  # whoever took a seat and says nothing has lost it by then
_PAUSE_S = 0.002


class _Watcher:
    """What goes on meanwhile: real payloads to spoil, services that end, the tick of each room."""

    def __init__(self, bus: Bus) -> None:
        self.heard: dict[str, deque[bytes]] = defaultdict(lambda: deque(maxlen=32))
        self.ended: Counter[str] = Counter()
        self.ticks: dict[str, int] = {}
        self.alive = set(bus.alive(keys.EVERY_ALIVE))
        bus.watch(keys.EVERY_ALIVE, self._on_token)
        bus.subscribe(keys.EVERY_STATUS, partial(self._hear, "RoomStatus"))
        bus.subscribe(keys.EVERY_STATE, partial(self._hear, "State"))
        bus.subscribe(keys.EVERY_EVENT, partial(self._hear, "Event"))
        bus.subscribe(keys.EVERY_COMMAND, partial(self._hear, "Command"))

    @property
    def rooms(self) -> list[str]:
        return [keys.last_of(key) for key in self.alive if f"/{ServiceKind.SIM}/" in key]

    def _on_token(self, key: str, alive: bool) -> None:
        if not alive:
            self.ended[key] += 1

    def _hear(self, name: str, sample: Sample) -> None:
        self.heard[name].append(sample.payload)
        if name == "RoomStatus":
            with contextlib.suppress(MartError):
                status = decode_received(RoomStatus, sample.payload)
                if status.room == keys.room_of(sample.key):
                    self.ticks[status.room] = status.tick


@click.command()
@click.option("--seconds", default=60.0, show_default=True)
@click.option("--seed", default=0, show_default=True)
def main(seconds: float, seed: int) -> None:
    """Make noise on the bus of the platform that MART_ROUTER names."""
    router = Settings().router
    with ZenohBus.connect(router, wait_for_router=False) as bus, ZenohBus.connect(router) as ear:
        watcher = _Watcher(ear)
        said, asked = _make_noise(bus, watcher, seconds, seed)
        before = dict(watcher.ticks)
        clock.sleep_s(_SETTLE_S)
        still = [room for room in watcher.rooms if watcher.ticks.get(room, 0) <= before.get(room, 0)]
    result = {"said": said, "asked": asked, "ended": watcher.ended, "standing_still": still}
    click.echo(json.dumps(result, indent=2))
    sys.exit(1 if watcher.ended or still else 0)


def _make_noise(
    bus: Bus, watcher: _Watcher, seconds: float, seed: int
) -> tuple[int, dict[str, Counter[str]]]:
    chance, noise = random.Random(seed), BusNoise(seed, watcher.heard)  # type: ignore[arg-type]
    publishers: dict[str, Publisher] = {}
    said, asked = 0, defaultdict[str, Counter[str]](Counter)
    until_s = clock.monotonic_s() + seconds
    while clock.monotonic_s() < until_s:
        broadcast = chance.choice(BROADCASTS)
        topic = _place(broadcast.topic, chance.choice([*watcher.rooms, "ghost-7"]))
        publisher = publishers.setdefault(topic.key, bus.publisher(topic))
        publisher.put(noise.payload(broadcast.message_type))
        said += 1
        if said % 20 == 0:
            queryable = chance.choice(QUERYABLES)
            for place in _asked(queryable.name, queryable.topic, watcher, chance):
                try:
                    answer = bus.query(place, noise.payload(queryable.request_type), _ASK_TIMEOUT_S)
                    reply = codec.decode(queryable.reply_type, answer)
                    asked[queryable.name][reply.error.code or "done"] += 1  # type: ignore[attr-defined]
                except Unavailable:
                    asked[queryable.name]["no answer"] += 1
        clock.sleep_s(_PAUSE_S)
    return said, asked


def _asked(name: str, topic: Callable[..., Topic], watcher: _Watcher, chance: random.Random) -> list[Topic]:
    kind = _KINDS[name]
    ids = watcher.rooms if kind is None else [
        keys.last_of(key) for key in watcher.alive if f"/{kind}/" in key
    ]  # fmt: skip
    return [_place(topic, chance.choice(ids))] if ids else []


def _place(topic: Callable[..., Topic], id: str) -> Topic:
    return topic(*(id, "arm0", "browser")[: topic.__code__.co_argcount])


if __name__ == "__main__":
    main()
