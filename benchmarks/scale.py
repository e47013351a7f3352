"""What a seat, a spectator and a room take of a core, and so how many of them one holds. No browsers run here.

Emulated phones drive, and peers that decode and draw nothing watch: what browsers take, they take elsewhere. What is
counted is time on a core of the platform's own processes, by kind; each figure is what one more of something adds. The
recorder and all others that every room and seat keeps busy are in it. The floor beside a room is its physics alone.
"""

from __future__ import annotations

import contextlib
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from report import Bar, report
from support.service_processes import cores_taken
from support.watchers import watching

from mart.platform.collect.emulated_users import EmulatedUsers
from mart.platform.collect.web_client import WebClient
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.room_manager import opening_rooms
from mart.platform.run.running import Platform, running_platform
from mart.runtime.ports import free_port
from mart.sim.world.world import World

TASK = "two_arm_multi_cube_lifting"
ARMS = ("arm0", "arm1")
CONTROL_HZ = 20.0
ROOMS = 3  # more of them
SPECTATORS = 7  # and the operator: eight look at one seat at most
SETTLE_S, WATCHED_S = 6.0, 20.0
PHYSICS_TICKS = 200

Cores = dict[str, float]


@contextlib.contextmanager
def platform_of_one_room() -> Iterator[Platform]:
    with tempfile.TemporaryDirectory() as folder:
        options = PlatformOptions(
            data_dir=Path(folder),
            router=f"tcp/127.0.0.1:{free_port()}",
            port=free_port(),
            control_hz=CONTROL_HZ,
            task=TASK,
            seed=0,
        )
        with running_platform(options) as platform, opening_rooms(platform):
            yield platform


def watched() -> Cores:
    time.sleep(SETTLE_S)
    return cores_taken(WATCHED_S)


@contextlib.contextmanager
def people(platform: Platform, number: int) -> Iterator[list[WebClient]]:
    """So many who have joined, and hold no seat."""
    with contextlib.ExitStack() as stack:
        clients = []
        for at in range(number):
            client = WebClient(platform.url, platform.certificate)
            stack.enter_context(contextlib.closing(client))
            client.join(platform.join_code, f"Watcher {at}")
            clients.append(client)
        yield clients


def seats_and_spectators(platform: Platform) -> dict[str, Cores]:
    """Return what is taken with nobody there, with one seat and with two; and with spectators of either kind."""
    room, users = platform.options.room, EmulatedUsers(platform, "expert", seed=0)
    taken = {"nobody": watched()}
    for ways, draws in (("video", False), ("page", True)):
        with users.seated(ARMS[:1]) as (ana,), watching([ana.web_client], room, ARMS[0], draws=draws):
            taken[f"seat_{ways}"] = watched()
            with people(platform, SPECTATORS) as clients, watching(clients, room, ARMS[0], draws=draws):
                taken[f"spectators_{ways}"] = watched()
    return taken


def more_rooms(platform: Platform) -> Cores:
    """Return what is taken with so many more rooms, in each of which a script moves every arm."""
    with people(platform, 1) as (host,):
        for _ in range(ROOMS):
            room = host.open_room(TASK, CONTROL_HZ)
            wait_for_room(host, room)
            for arm in ARMS:
                host.assign(room, arm, "script")
        return watched()


def wait_for_room(client: WebClient, room: str) -> None:
    until_s = time.monotonic() + 60.0
    while not client.is_room_answering(room):
        if time.monotonic() > until_s:
            raise TimeoutError(f"{room} does not answer.")
        time.sleep(0.2)


def physics_alone() -> float:
    """Return the cores that the physics of one room takes at this rate."""
    world = World.build(TASK, CONTROL_HZ)
    world.reset(seed=0)
    still = np.zeros((len(world.arms), 7))
    begun_s = time.process_time()
    for _ in range(PHYSICS_TICKS):
        world.step(still)
    return (time.process_time() - begun_s) / PHYSICS_TICKS * CONTROL_HZ


def added(more: Cores, less: Cores, by: int = 1) -> Cores:
    return {kind: (more.get(kind, 0.0) - less.get(kind, 0.0)) / by for kind in {*more, *less}}


def in_words(cores: Cores) -> str:
    parts = sorted(((used, kind) for kind, used in cores.items() if kind != "all"), reverse=True)
    return ", ".join(f"{kind} {used:.3f}" for used, kind in parts if used >= 0.005)


def main() -> None:
    with platform_of_one_room() as platform:
        taken = seats_and_spectators(platform)
        rooms = more_rooms(platform)
    adds = {
        "seat_video": added(taken["seat_video"], taken["nobody"]),
        "seat_page": added(taken["seat_page"], taken["nobody"]),
        "spectator_video": added(taken["spectators_video"], taken["seat_video"], SPECTATORS),
        "spectator_page": added(taken["spectators_page"], taken["seat_page"], SPECTATORS),
        "room": added(rooms, taken["nobody"], ROOMS),
    }
    metrics: dict[str, float | str] = {"platform_at_rest_cores": taken["nobody"]["all"]}
    for name, cores in adds.items():
        metrics[f"{name}_cores"] = cores["all"]
        metrics[f"{name}_a_core"] = 1.0 / max(cores["all"], 0.002)  # what can be told apart
        metrics[f"{name}_taken_by"] = in_words(cores)
    floor = physics_alone()
    drawn, undrawn = (float(metrics[f"spectator_{way}_cores"]) for way in ("video", "page"))
    bars = [
        Bar.at_most("a spectator's share of a core, server-drawn", drawn, 0.05),
        Bar.at_most("a spectator's share of a core, page-drawn", undrawn, 0.05),
        Bar.at_most(
            "a page-drawn seat, of a server-drawn one",
            adds["seat_page"]["all"] / adds["seat_video"]["all"],
            0.5,
        ),
    ]
    report("scale", metrics, {"room_physics_alone_cores": floor}, bars)


if __name__ == "__main__":
    main()
