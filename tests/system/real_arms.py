"""A rehearsal with real processes: simulated hardware behind sockets, drivers, and people of software at the seats."""

from __future__ import annotations

import contextlib
import json
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from mart.operators import Operator, SeatView, ToolTarget
from mart.operators.commander import SeatCommander
from mart.protocol import clock, codec, keys
from mart.protocol.messages import OPERATOR_HUMAN, State
from mart.protocol.pose import Pose
from mart.protocol.tasks import Task
from mart.runtime.ports import free_port
from tests.system.room_client import RoomClient

_MOVES_RAD = 0.002
_COMMANDS_S = 0.05


class Hardware:
    """One simulated arm's hardware, and a line to it for what a rehearsal asks."""

    def __init__(self, seed: int) -> None:
        command = [sys.executable, "-m", "mart.driver.simulated", "--port", "0", "--seed", str(seed)]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self._line: socket.socket | None = None
        self.port = 0

    def await_port(self) -> None:
        assert self._process.stdout is not None
        self.port = int(self._process.stdout.readline())
        self._line = socket.create_connection(("127.0.0.1", self.port))

    def ask(self, **what: Any) -> None:
        assert self._line is not None
        self._line.sendall(json.dumps(what).encode() + b"\n")

    def history(self, since_s: float) -> np.ndarray:
        """Where the joints were since then: rows of a time of this machine, and joint positions."""
        with socket.create_connection(("127.0.0.1", self.port)) as line:
            line.sendall(json.dumps({"history_s": clock.monotonic_s() - since_s}).encode() + b"\n")
            with line.makefile("rb") as lines:
                for said in lines:
                    if b"history" in said:
                        return np.array(json.loads(said)["history"])
        raise AssertionError("The hardware said no history.")

    def stood_after_s(self, since_s: float) -> float:
        """For how long it still moved after this time."""
        rows = self.history(since_s)
        moving = np.abs(rows[:, 1:] - rows[-1, 1:]).max(axis=1) > _MOVES_RAD
        return float(rows[moving, 0].max() - since_s) if moving.any() else 0.0

    def moved_rad(self, since_s: float) -> float:
        """By how much a joint moved since then."""
        return float(np.ptp(self.history(since_s)[:, 1:], axis=0).max())

    def close(self) -> None:
        if self._line is not None:
            self._line.close()
        self._process.kill()
        self._process.wait()


class Swinger(Operator):
    """Swings the tool sideways for ever, about where it was when the clutch was pressed."""

    def begin(self, episode: int) -> None:
        self._middle: Pose | None = None

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        ((arm, tool),) = view.poses_tool_in_base.items()
        if self._middle is None:
            self._middle, self._begun_s = tool, view.sim_time_s
        away_m = 0.10 * np.sin(2.5 * (view.sim_time_s - self._begun_s))
        target = Pose(self._middle.position + np.array([0.0, away_m, 0.0]), self._middle.quaternion_wxyz)
        return {arm: ToolTarget(target, 0.0)}


class Person:
    """Sits at a seat as a human. While the clutch is pressed, `operator` says where the tool is to go."""

    def __init__(self, client: RoomClient, arm: str, task: Task, operator: Operator) -> None:
        seat = client.claim(arm, f"holder-of-{arm}", name=f"Person {arm}").seat
        self._commander = SeatCommander(operator, task, (arm,), OPERATOR_HUMAN)
        self._commander.seat({arm: seat.epoch})
        self._arm, self._lock, self._closing = arm, threading.Lock(), threading.Event()
        self._tool = self._held = Pose.identity()
        self._gripper, self.engaged, self._heard = 0.0, False, False
        self._publisher = client.bus.publisher(keys.command(client.room, arm))
        self._subscription = client.bus.subscribe(
            keys.state(client.room).key, lambda s: self._hear(s.payload)
        )
        self._thread = threading.Thread(target=self._speak, daemon=True)
        self._thread.start()

    def release(self) -> None:
        with self._lock:
            self.engaged, self._held = False, self._tool

    def press(self) -> None:
        with self._lock:
            self.engaged = True

    def close(self) -> None:
        self._closing.set()
        self._thread.join()
        self._subscription.close()

    def _hear(self, payload: bytes) -> None:
        state = codec.decode(State, payload)
        tool = next(arm.tool_in_base for arm in state.arms if arm.arm == self._arm)
        with self._lock:
            self._tool = Pose(
                np.array([tool.x, tool.y, tool.z]), np.array([tool.qw, tool.qx, tool.qy, tool.qz])
            )
            if not self._heard:
                self._heard, self._held = True, self._tool
            news = self._commander.observe(state)
        if news:
            self._give()

    def _speak(self) -> None:
        while not self._closing.wait(_COMMANDS_S):
            self._give()

    def _give(self) -> None:
        with self._lock:
            for command in self._commander.commands(clock.wall_ns()):
                if not self.engaged:
                    x, y, z = self._held.position.tolist()
                    qw, qx, qy, qz = self._held.quaternion_wxyz.tolist()
                    target = command.target_tool_in_base
                    target.x, target.y, target.z, target.qw, target.qx, target.qy, target.qz = (
                        x,
                        y,
                        z,
                        qw,
                        qx,
                        qy,
                        qz,
                    )
                    command.gripper, command.engaged = self._gripper, False
                self._gripper = command.gripper
                self._publisher.put(codec.encode(command))


class CuttableLink:
    """Passes a connection on to a router, until it is cut."""

    def __init__(self, endpoint: str) -> None:
        self._target = ("127.0.0.1", int(endpoint.rpartition(":")[2]))
        self._server = socket.create_server(("127.0.0.1", free_port()))
        self.endpoint = f"tcp/127.0.0.1:{self._server.getsockname()[1]}"
        self.whole = True
        threading.Thread(target=self._accept, daemon=True).start()

    def close(self) -> None:
        self.whole = False
        self._server.close()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                near, _ = self._server.accept()
                far = socket.create_connection(self._target)
                for one, other in ((near, far), (far, near)):
                    threading.Thread(target=self._pass_on, args=(one, other), daemon=True).start()

    def _pass_on(self, one: socket.socket, other: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while piece := one.recv(65536):
                while not self.whole:  # nothing comes through, and nobody is told
                    threading.Event().wait(0.01)
                other.sendall(piece)
        for end in (one, other):
            end.close()


@contextlib.contextmanager
def hardware() -> Iterator[dict[str, Hardware]]:
    """Two arms' hardware."""
    both = {arm: Hardware(seed) for seed, arm in enumerate(("arm0", "arm1"))}
    try:
        for one in both.values():
            one.await_port()
        yield both
    finally:
        for one in both.values():
            one.close()


def until(happens: Callable[[], bool], why: Callable[[], str], timeout_s: float = 30.0) -> None:
    """Waits for what only asking tells; `why` it did not happen is told where it takes too long."""
    deadline_s = clock.monotonic_s() + timeout_s
    while not happens():
        if clock.monotonic_s() >= deadline_s:
            raise AssertionError(why())
        clock.sleep_s(0.05)
