"""What the way to a real arm costs: from a command at the gateway to the servo's next target, beside a bare Zenoh trip.

Router, sim, driver and simulated hardware are processes of their own. This one is the gateway: when the pace allows the
next tick, it gives the command that the barrier waits for, and listens as the driver does. `target` is the time until
the tick's ArmTarget is heard, `servo` that until a reading is heard which says that the servo follows it: that one
holds the servo's period (8 ms) and the reading's way back. The peer is a message of a command's size to an echo and
back: two hops, as from the gateway over the sim to the driver.
"""

from __future__ import annotations

import contextlib
import queue
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

import numpy as np
from barrier import ECHO
from report import Bar, report
from support.bus_processes import await_alive, child

from mart.protocol import clock, codec, keys
from mart.protocol.errors import MartError
from mart.protocol.messages import (
    OPERATOR_HUMAN,
    ArmMeasured,
    ArmTarget,
    Command,
    EpisodeRequest,
    RoomReply,
    SeatRequest,
    State,
    raise_error,
)
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.ask import ask
from mart.runtime.bus import Bus, Sample
from mart.runtime.bus.zenoh_bus import ZenohBus

ROOM, ARM = "bench-driver", "arm0"
CONTROL_HZ = 20.0
ROUNDS, WARM_UP = 300, 20
BAR_MS = (
    5.0  # of the median, over the bare trip: the tick's arithmetic before physics, and the wait for a core
)
PORT = 17580
LOST_AFTER_S = 2.0


def main() -> None:
    endpoint = f"tcp/127.0.0.1:{PORT}"
    hardware = subprocess.Popen(
        [sys.executable, "-m", "mart.driver.simulated", "--port", "0"], stdout=subprocess.PIPE, text=True
    )
    assert hardware.stdout is not None
    address = f"address=127.0.0.1:{int(hardware.stdout.readline())}"
    sim = ["mart", "sim", "--room", ROOM, "--driver", ARM, "--control-hz", str(CONTROL_HZ), "--seed", "1"]
    driver = [
        "mart",
        "driver",
        "--room",
        ROOM,
        "--arm",
        ARM,
        "--driver",
        "mart.driver.simulated:SimulatedArm",
    ]
    with (
        contextlib.ExitStack() as opened,
        tempfile.TemporaryDirectory() as folder,
        child("mart", "router", "--listen", endpoint),
    ):
        opened.callback(hardware.kill)
        environment = {"MART_ROUTER": endpoint, "MART_DATA_DIR": folder}
        echo = [sys.executable, str(Path(__file__).with_name("barrier.py")), "echo"]
        for command in (sim, [*driver, "--option", address], echo):
            opened.enter_context(child(*command, **environment))
        bus = opened.enter_context(ZenohBus.connect(endpoint))
        for kind, name in ((ServiceKind.DRIVER, f"{ROOM}-{ARM}"), (ServiceKind.OPERATE, ECHO)):
            await_alive(bus, keys.alive(kind, name))
        figures = Gateway(bus).measure()
    metrics = {
        f"{way}_{name}_ms": value for way in ("target", "servo") for name, value in _of(figures[way]).items()
    }
    peer = {f"bare_round_trip_{name}_ms": value for name, value in _of(figures["bare"]).items()}
    over_ms = metrics["target_p50_ms"] - peer["bare_round_trip_p50_ms"]
    report("driver", metrics, peer, [Bar.at_most("median of target over the bare trip, ms", over_ms, BAR_MS)])


def _of(figures_ms: list[float]) -> dict[str, float]:
    return {f"p{share}": float(np.percentile(figures_ms[WARM_UP:], share)) for share in (50, 95)}


class Gateway:
    """Drives the arm as a person's gateway does, and takes the times."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._heard: queue.SimpleQueue[tuple[float, str, bytes]] = queue.SimpleQueue()
        for name, topic in (
            ("state", keys.state(ROOM)),
            ("target", keys.arm_target(ROOM, ARM)),
            ("measured", keys.arm_measured(ROOM, ARM)),
            ("echo", keys.state(ECHO)),
        ):
            bus.subscribe(topic.key, partial(self._hear, name))
        self._command, self._echo = (
            bus.publisher(keys.command(ROOM, ARM)),
            bus.publisher(keys.command(ECHO, ARM)),
        )
        self._sequence = 0
        self._state = State()

    def _hear(self, name: str, came: Sample) -> None:
        self._heard.put((clock.monotonic_s(), name, came.payload))

    def measure(self) -> dict[str, list[float]]:
        """Return milliseconds by way."""
        claim = SeatRequest.Claim(arm=ARM, holder_id="bench", name="Bench", operator=OPERATOR_HUMAN)
        reply = ask(self._bus, keys.seat(ROOM), SeatRequest(claim=claim), RoomReply, 10.0)
        raise_error(reply.error)
        self._epoch = reply.seat.epoch
        figures: dict[str, list[float]] = {"target": [], "servo": [], "bare": []}
        while len(figures["servo"]) < WARM_UP + ROUNDS:
            self._run()
            with contextlib.suppress(queue.Empty):
                for way, took_ms in self._tick().items():
                    figures[way].append(took_ms)
                figures["bare"].append(self._bare())
        return figures

    def _run(self) -> None:
        """Let the room go on, and press the clutch, where it does not run."""
        go_on = EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Bench"))
        with contextlib.suppress(MartError):  # nothing is stopped, or the driver is not ready
            ask(self._bus, keys.episode(ROOM), go_on, RoomReply, 10.0)
            for engaged in (False, True):
                for _ in range(8):
                    self._give(engaged=engaged)
                    clock.sleep_s(1.0 / CONTROL_HZ)

    def _tick(self) -> dict[str, float]:
        clock.sleep_s(1.5 / CONTROL_HZ)
        self._drain()
        begun_s = clock.monotonic_s()
        self._give(engaged=True)
        took: dict[str, float] = {}
        tick = self._state.tick + 1
        while "servo" not in took:
            at_s, name, payload = self._heard.get(timeout=LOST_AFTER_S)
            if (
                name == "target"
                and (target := codec.decode(ArmTarget, payload)).tick >= tick
                and not target.stop
            ):
                took.setdefault("target", (at_s - begun_s) * 1e3)
            if name == "measured" and codec.decode(ArmMeasured, payload).follows_tick >= tick:
                took["servo"] = (at_s - begun_s) * 1e3
            if at_s - begun_s > LOST_AFTER_S:
                raise queue.Empty
        return took

    def _bare(self) -> float:
        self._drain()
        begun_s = clock.monotonic_s()
        self._echo.put(bytes(200) + (200).to_bytes(4, "little"))
        while True:
            at_s, name, _ = self._heard.get(timeout=LOST_AFTER_S)
            if name == "echo":
                return (at_s - begun_s) * 1e3

    def _drain(self) -> None:
        with contextlib.suppress(queue.Empty):
            while True:
                _, name, payload = self._heard.get_nowait()
                if name == "state":
                    self._state = codec.decode(State, payload)

    def _give(self, *, engaged: bool) -> None:
        self._drain()
        self._sequence += 1
        arm = next((one for one in self._state.arms if one.arm == ARM), None)
        if arm is None:
            return
        command = Command(
            arm=ARM,
            seat_epoch=self._epoch,
            sequence=self._sequence,
            target_tool_in_base=arm.tool_in_base,
            engaged=engaged,
        )
        self._command.put(codec.encode(command))


if __name__ == "__main__":
    main()
