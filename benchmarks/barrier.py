"""Last command in → state out, less the physics: what the sim adds to a bare round trip over the bus.

A router, a sim and an echo run as processes of their own. This one plays all operators. All but one stream 60 commands
a second, as phones do; when the pace allows the next tick, the last one sends its command and waits for the state.
Between two ticks it sends a command of the same size to the echo, which answers at once with as many bytes as a state
has. Physics time is taken from the state's own stamps. A p99 is that of a block of rounds and hangs on four of them, so
the bar takes the median of several blocks.

Two and four arms are `mart sim` as it is. No task has eight arms: there, the same loop runs over two rooms' worth of
world, stepped one after the other.
"""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray
from report import Bar, report, spread

from mart.protocol import clock, codec, keys
from mart.protocol.bus import Bus, Publisher
from mart.protocol.bus.zenoh_bus import ZenohBus
from mart.protocol.messages import (
    OPERATOR_SCRIPT,
    Command,
    PoseMessage,
    RoomReply,
    SeatRequest,
    State,
    raise_error,
)
from mart.protocol.pose import Pose
from mart.protocol.service import announced, connected
from mart.sim.serving import serve_world
from mart.sim.settings import DEFAULT_TASK, SimSettings
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
    with tempfile.TemporaryDirectory() as folder, _child("mart", "router", "--listen", endpoint):
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
        _child(*sim, **environment),
        _child(sys.executable, __file__, "echo", **environment),
        ZenohBus.connect(endpoint) as bus,
    ):
        for kind, name in (("sim", room), ("bench", ECHO)):
            _await_alive(bus, keys.alive(kind, name))
        return Operators(bus, room, arms).measure()


class Operators:
    """All operators of a room, and the one who waits for its states. All but the last stream as phones do."""

    def __init__(self, bus: Bus, room: str, arms: int) -> None:
        *early, self._last = (f"arm{index}" for index in range(arms))
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
        self._publishers = {arm: bus.publisher(keys.command(room, arm)) for arm in (*early, self._last)}
        self._epochs = {arm: _seat(bus, room, arm) for arm in self._publishers}
        self._sequences = dict.fromkeys(self._publishers, 0)
        self._stop = threading.Event()
        self._stream = threading.Thread(target=self._give_again_and_again, args=(early,))

    def measure(self) -> Times:
        state = self._next_state()[1]
        sim: list[float] = []
        bare: list[float] = []
        self._stream.start()
        while len(sim) < WARM_UP + BLOCKS * ROUNDS:
            # Under load the bus drops a command now and then, which is its right: such a round is begun again.
            with contextlib.suppress(queue.Empty):
                tick_ms, state = self._tick()
                echo_ms = self._round_trip(size=state.ByteSize())
                bare.append(echo_ms)
                sim.append(tick_ms)
        self._stop.set()
        self._stream.join()
        return Times(*(np.reshape(figures[WARM_UP:], (BLOCKS, ROUNDS)) for figures in (sim, bare)))

    def _give_again_and_again(self, arms: list[str]) -> None:
        while not self._stop.is_set():
            for arm in arms:
                self._publishers[arm].put(self._command(arm))
                clock.sleep_s(1.0 / (PHONE_HZ * len(arms)))

    def _tick(self) -> tuple[float, State]:
        """Milliseconds from the last command to the next state, less the physics; that state."""
        clock.sleep_s(1.5 / CONTROL_HZ)
        payload = self._command(self._last)
        sent_ns = clock.monotonic_ns()
        self._publishers[self._last].put(payload)
        arrived_ns, after = self._next_state()
        physics_ns = after.stamps.stepped_ns - after.stamps.fired_ns
        return (arrived_ns - sent_ns - physics_ns) / 1e6, after

    def _command(self, arm: str) -> bytes:
        """The next one: the tool half a metre ahead of the base."""
        self._sequences[arm] += 1
        return codec.encode(
            Command(
                arm=arm,
                seat_epoch=self._epochs[arm],
                sequence=self._sequences[arm],
                target_tool_in_base=PoseMessage(x=0.5, z=0.2, qw=1.0),
                engaged=True,
            )
        )

    def _next_state(self) -> tuple[int, State]:
        """When the state came that used the last arm's newest command, and the state. Raises queue.Empty if none."""
        deadline_s = clock.monotonic_s() + LOST_AFTER_S
        while True:
            at_ns, payload = self._states.get(timeout=max(0.0, deadline_s - clock.monotonic_s()))
            state = codec.decode(State, payload)
            if state.arms[-1].sequence == self._sequences[self._last]:
                return at_ns, state

    def _round_trip(self, size: int) -> float:
        """Milliseconds to the echo and back, a command one way, `size` bytes the other."""
        while not self._echoes.empty():
            self._echoes.get()
        clock.sleep_s(1.5 / CONTROL_HZ)  # both trips begin on a machine that has rested as long
        payload = self._command(self._last) + size.to_bytes(4, "little")
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
    with connected(SimSettings(), "bench", ECHO) as service:
        answer: Publisher = service.bus.publisher(keys.state(ECHO))
        subscription = service.bus.subscribe(
            keys.command(ECHO, "arm0").key,
            lambda sample: answer.put(bytes(int.from_bytes(sample.payload[-4:], "little"))),
        )
        with contextlib.closing(subscription), announced(service):
            service.stop.wait()


class PairOfWorlds:
    """Two worlds of four arms, told apart by numbering the second one's arms on. A World by what it does."""

    def __init__(self) -> None:
        self._worlds = [World.build(DEFAULT_TASK, CONTROL_HZ, 4) for _ in range(2)]
        first = self._worlds[0]
        self._home = {
            f"arm{index}": (first if index < 4 else self._worlds[1], f"arm{index % 4}") for index in range(8)
        }
        self.arms = tuple(self._home)
        self.task = first.task
        self.control_period_s = first.control_period_s
        self.model_sha256 = first.model_sha256
        self.model_bytes = first.model_bytes
        self.progress = first.progress

    @property
    def sim_time_s(self) -> float:
        return self._worlds[0].sim_time_s

    def reset(self, seed: int) -> None:
        for world in self._worlds:
            world.reset(seed)

    def tool_pose_in_base(self, arm: str) -> Pose:
        world, name = self._home[arm]
        return world.tool_pose_in_base(name)

    def gripper(self, arm: str) -> float:
        world, name = self._home[arm]
        return world.gripper(name)

    def action_for(self, arm: str, target_tool_in_base: Pose, gripper: float) -> NDArray[np.float64]:
        world, name = self._home[arm]
        return world.action_for(name, target_tool_in_base, gripper)

    def step(self, actions: ArrayLike) -> None:
        for world, share in zip(self._worlds, np.split(np.asarray(actions), 2), strict=True):
            world.step(share)

    def integration_state(self) -> bytes:
        return b"".join(world.integration_state() for world in self._worlds)

    def observations(self) -> dict[str, NDArray[np.float64]]:
        second = {_renumbered(name): value for name, value in self._worlds[1].observations().items()}
        return {**self._worlds[0].observations(), **second}


def _renumbered(name: str) -> str:
    thing, _, rest = name.partition("/")
    return f"{thing[:-1]}{int(thing[-1]) + 4}/{rest}"


def serve_pair(room: str) -> None:
    serve_world(SimSettings(room=room, seed=1), cast("World", PairOfWorlds()))


@contextlib.contextmanager
def _child(*command: str, **environment: str) -> Iterator[None]:
    program = str(Path(sys.executable).with_name(command[0])) if command[0] == "mart" else command[0]
    process = subprocess.Popen([program, *command[1:]], env={**os.environ, **environment})
    try:
        yield
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait()


def _await_alive(bus: Bus, key: str) -> None:
    alive = threading.Event()
    with contextlib.closing(bus.watch(key, lambda _, present: alive.set() if present else None)):
        if not alive.wait(30):
            raise SystemExit(f"{key} did not come up within 30 s")


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["echo"]:
            echo()
        case ["serve-pair", room]:
            serve_pair(room)
        case _:
            main()
