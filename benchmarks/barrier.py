"""Last command in → state out, less the physics: what the sim adds to a bare round trip over the bus.

A router, a sim and an echo run as processes of their own, and one plays all operators but the last: each streams 60
commands a second, as a phone does. This one plays the last operator alone, because gateways are processes of their own
too: when the pace allows the next tick, it sends its command and waits for the state.
Between two ticks it sends a command of the same size to the echo, which answers at once with as many bytes as a state
has. Physics time is taken from the state's own stamps. A p99 is that of a block of rounds and hangs on four of them, so
the bar takes the median of several blocks.

Two and four arms are `mart sim` as it is. No task has eight arms: there, the same loop runs over two rooms' worth of
world, stepped one after the other.
"""

from __future__ import annotations

import contextlib
import itertools
import queue
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import NDArray
from report import Bar, report, spread
from support.bus_processes import await_alive, child
from support.pair_of_worlds import PairOfWorlds

from mart.protocol import clock, codec, keys
from mart.protocol.messages import (
    OPERATOR_SCRIPT,
    Command,
    PoseMessage,
    RoomReply,
    SeatRequest,
    State,
    raise_error,
)
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus, Publisher
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.service import announced, connected
from mart.sim.room.serving import serve_world
from mart.sim.settings import SimSettings
from mart.sim.world import World

CONTROL_HZ = 100.0  # the rhythm only spaces the samples
BLOCKS = 5
ROUNDS = 400  # a block
WARM_UP = 50
BAR_MS = 1.0
LOST_AFTER_S = 2.0
PHONE_HZ = 60.0
ECHO = "bench-echo"
ENDPOINT_PORT = 17560
ARMS = (2, 4, 8)


@dataclass(frozen=True)
class Times:
    """Milliseconds, one a round: shape (blocks, rounds)."""

    sim: NDArray[np.float64]
    bare: NDArray[np.float64]


def main() -> None:
    endpoint = f"tcp/127.0.0.1:{ENDPOINT_PORT}"
    metrics: dict[str, float] = {}
    peer: dict[str, float] = {}
    bars = []
    with tempfile.TemporaryDirectory() as folder, child("mart", "router", "--listen", endpoint):
        for arms in ARMS:
            times = _measure(arms, endpoint, Path(folder))
            sim, bare = (_percentiles(blocks) for blocks in (times.sim, times.bare))
            over_ms = sim["p99"] - bare["p99"]
            for name in ("p50", "p99"):
                metrics |= spread(f"{arms}_arms_{name}_ms", sim[name].tolist())
                peer |= spread(f"bare_round_trip_beside_{arms}_arms_{name}_ms", bare[name].tolist())
            metrics |= spread(f"{arms}_arms_p99_over_bare_ms", over_ms.tolist())
            bars.append(
                Bar.at_most(f"{arms} arms: p99 over the bare trip, ms", float(np.median(over_ms)), BAR_MS)
            )
    report("barrier", metrics, peer, bars)


def _percentiles(blocks: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Of every block: shape (blocks,)."""
    return {"p50": np.percentile(blocks, 50, axis=1), "p99": np.percentile(blocks, 99, axis=1)}


def _measure(arms: int, endpoint: str, folder: Path) -> Times:
    room = f"bench-{arms}"
    options = ["--room", room, "--arms", str(arms), "--control-hz", str(CONTROL_HZ), "--seed", "1"]
    sim = ["mart", "sim", *options] if arms <= 4 else [sys.executable, __file__, "serve-pair", room]
    environment = {"MART_ROUTER": endpoint, "MART_DATA_DIR": str(folder)}
    with (
        child(*sim, **environment),
        child(sys.executable, __file__, "echo", **environment),
        ZenohBus.connect(endpoint) as bus,
    ):
        for kind, name in ((ServiceKind.SIM, room), (ServiceKind.OPERATE, ECHO)):
            await_alive(bus, keys.alive(kind, name))
        *early, last = (f"arm{index}" for index in range(arms))
        seats = [f"{arm}:{_seat(bus, room, arm)}" for arm in early]
        with child(sys.executable, __file__, "stream", room, *seats, **environment):
            return LastOperator(bus, room, last).measure()


def stream(room: str, *seats: str) -> None:
    """The operators of all `seats` ("ARM:EPOCH") but the last one's: 60 commands a second each."""
    epochs = {arm: int(epoch) for arm, _, epoch in (seat.partition(":") for seat in seats)}
    with connected(SimSettings(), ServiceKind.OPERATE, "bench-stream") as service:
        publishers = {arm: service.bus.publisher(keys.command(room, arm)) for arm in epochs}
        for sequence in itertools.count(1):
            for arm, publisher in publishers.items():
                publisher.put(_command(arm, epochs[arm], sequence))
                if service.stop.wait(1.0 / (PHONE_HZ * len(publishers))):
                    return


def _command(arm: str, epoch: int, sequence: int) -> bytes:
    """The tool half a metre ahead of the base."""
    return codec.encode(
        Command(
            arm=arm,
            seat_epoch=epoch,
            sequence=sequence,
            target_tool_in_base=PoseMessage(x=0.5, z=0.2, qw=1.0),
            engaged=True,
        )
    )


class LastOperator:
    """The operator who completes the barrier, and who waits for the states."""

    def __init__(self, bus: Bus, room: str, arm: str) -> None:
        self._arm = arm
        self._states: queue.SimpleQueue[tuple[int, bytes]] = queue.SimpleQueue()
        self._echoes: queue.SimpleQueue[tuple[int, bytes]] = queue.SimpleQueue()
        self._subscriptions = (
            bus.subscribe(
                keys.state(room).key, lambda came: self._states.put((clock.monotonic_ns(), came.payload))
            ),
            bus.subscribe(
                keys.state(ECHO).key, lambda came: self._echoes.put((clock.monotonic_ns(), came.payload))
            ),
        )
        self._echo = bus.publisher(keys.command(ECHO, "arm0"))
        self._publisher = bus.publisher(keys.command(room, arm))
        self._epoch = _seat(bus, room, arm)
        self._sequence = 0

    def measure(self) -> Times:
        state = self._next_state()[1]
        sim: list[float] = []
        bare: list[float] = []
        while len(sim) < WARM_UP + BLOCKS * ROUNDS:
            # Under load the bus drops a command now and then, which is its right: such a round is begun again.
            with contextlib.suppress(queue.Empty):
                tick_ms, state = self._tick()
                echo_ms = self._round_trip(size=state.ByteSize())
                bare.append(echo_ms)
                sim.append(tick_ms)
        return Times(*(np.reshape(figures[WARM_UP:], (BLOCKS, ROUNDS)) for figures in (sim, bare)))

    def _tick(self) -> tuple[float, State]:
        """Milliseconds from the last command to the next state, less the physics; that state."""
        clock.sleep_s(1.5 / CONTROL_HZ)
        payload = self._next_command()
        sent_ns = clock.monotonic_ns()
        self._publisher.put(payload)
        arrived_ns, after = self._next_state()
        physics_ns = after.stamps.stepped_ns - after.stamps.fired_ns
        return (arrived_ns - sent_ns - physics_ns) / 1e6, after

    def _next_command(self) -> bytes:
        self._sequence += 1
        return _command(self._arm, self._epoch, self._sequence)

    def _next_state(self) -> tuple[int, State]:
        """When the state came that used the last arm's newest command, and the state. Raises queue.Empty if none."""
        deadline_s = clock.monotonic_s() + LOST_AFTER_S
        while True:
            at_ns, payload = self._states.get(timeout=max(0.0, deadline_s - clock.monotonic_s()))
            state = codec.decode(State, payload)
            if state.arms[-1].sequence == self._sequence:
                return at_ns, state

    def _round_trip(self, size: int) -> float:
        """Milliseconds to the echo and back, a command one way, `size` bytes the other."""
        while not self._echoes.empty():
            self._echoes.get()
        clock.sleep_s(1.5 / CONTROL_HZ)  # both trips begin on a machine that has rested as long
        payload = self._next_command() + size.to_bytes(4, "little")
        sent_ns = clock.monotonic_ns()
        self._echo.put(payload)
        return (self._echoes.get(timeout=LOST_AFTER_S)[0] - sent_ns) / 1e6


def _seat(bus: Bus, room: str, arm: str) -> int:
    """Sets an arm to script; the epoch of its seat."""
    request = SeatRequest(assign=SeatRequest.Assign(arm=arm, operator=OPERATOR_SCRIPT))
    reply = codec.decode(RoomReply, bus.query(keys.seat(room), codec.encode(request), timeout_s=10))
    raise_error(reply.error)
    return reply.seat.epoch


def echo() -> None:
    """Answers each command with as many bytes as it asks for."""
    with connected(SimSettings(), ServiceKind.OPERATE, ECHO) as service:
        answer: Publisher = service.bus.publisher(keys.state(ECHO))
        subscription = service.bus.subscribe(
            keys.command(ECHO, "arm0").key,
            lambda sample: answer.put(bytes(int.from_bytes(sample.payload[-4:], "little"))),
        )
        with contextlib.closing(subscription), announced(service):
            service.stop.wait()


def serve_pair(room: str) -> None:
    serve_world(SimSettings(room=room, seed=1), cast("World", PairOfWorlds(CONTROL_HZ)))


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["echo"]:
            echo()
        case ["stream", room, *seats]:
            stream(room, *seats)
        case ["serve-pair", room]:
            serve_pair(room)
        case _:
            main()
