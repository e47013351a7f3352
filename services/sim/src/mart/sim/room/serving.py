"""Serve a room: settings in, a running sim until it is asked to stop."""

from __future__ import annotations

import contextlib
import gc
import logging
from collections import Counter
from collections.abc import Callable

from mart.protocol import clock
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.service import announced, connected
from mart.runtime.throttled_log import ThrottledLog
from mart.runtime.watchdog import Watchdog
from mart.sim.experts import Skill, get_skill
from mart.sim.room import saved_room
from mart.sim.room.bus_publisher import BusPublisher, OrderedPublisher
from mart.sim.room.episode_state_machine import Terms
from mart.sim.room.room import Room
from mart.sim.room.room_server import RoomServer
from mart.sim.room.saved_room import SavedRoom
from mart.sim.room.serial_executor import SerialExecutor
from mart.sim.room.unpaced_room import SimulatedTime, UnpacedRoom
from mart.sim.room.work_queue import WorkQueue
from mart.sim.settings import SimSettings
from mart.sim.world import World
from mart.sim.world.divergence import DivergenceArchive

_log = logging.getLogger(__name__)

DEFAULT_SKILL = "expert"


def serve_room(settings: SimSettings) -> None:
    """Build the world of `settings` and serve its room.

    Raises what building a world raises, and NotFound for an unknown skill.
    """
    skill = get_skill(settings.skill) if settings.skill else None
    world = World.build(settings.task, settings.control_hz, settings.arms)
    if settings.lockstep:
        serve_unpaced(settings, world, skill or get_skill(DEFAULT_SKILL))
    else:
        serve_world(settings, world)


def serve_world(settings: SimSettings, world: World) -> None:
    """Serve the room of `settings` around a world that exists already."""
    with connected(settings, ServiceKind.SIM, settings.room) as service, contextlib.ExitStack() as opened:
        publisher = opened.enter_context(contextlib.closing(BusPublisher(service.bus, settings.room)))
        room = Room(
            settings.room,
            world,
            _record(settings),
            publisher,
            _keeper(settings),
            now_s=clock.monotonic_s(),
            pace=settings.pace,
            terms=Terms(skill=settings.skill or "", time_limit_s=settings.time_limit_s),
            explain=_archive(settings).keep,
        )
        throttled_log, garbled = ThrottledLog(_log), Counter[str]()

        watchdog = Watchdog(f"The room {settings.room}")

        def advance(now_s: float) -> float:
            watchdog.feed()
            next_s = room.advance(now_s)
            throttled_log.report(Counter(room.rejected) + garbled, now_s)
            return next_s

        executor = SerialExecutor(advance)
        server = RoomServer(
            service.bus,
            settings.room,
            room,
            world,
            submit=executor.submit,
            leave=executor.leave,
            garbled=garbled,
            looks=_looks(settings),
        )
        opened.enter_context(contextlib.closing(server))
        server.hear_commands()
        opened.enter_context(announced(service))
        gc.freeze()  # what is here now stays: later collections need not look at it
        with watchdog:
            executor.run(service.stop)


def serve_unpaced(settings: SimSettings, world: World, skill: Skill) -> None:
    """Serve the same room on simulated time, with its scripts."""
    with connected(settings, ServiceKind.SIM, settings.room) as service, contextlib.ExitStack() as opened:
        work_queue, garbled, time = WorkQueue(), Counter[str](), SimulatedTime()
        publisher = OrderedPublisher(service.bus, settings.room, world.arms)
        opened.enter_context(contextlib.closing(publisher))
        terms = Terms(lockstep=True, skill=skill.name, time_limit_s=settings.time_limit_s)
        room = Room(
            settings.room,
            world,
            _record(settings),
            publisher,
            _keeper(settings),
            now_s=time.now_s(),
            terms=terms,
            explain=_archive(settings).keep,
        )
        server = RoomServer(
            service.bus,
            settings.room,
            room,
            world,
            submit=work_queue.put,
            leave=work_queue.put,
            garbled=garbled,
            now_s=time.now_s,
        )
        opened.enter_context(contextlib.closing(server))
        watchdog = Watchdog(f"The room {settings.room}")
        unpaced = UnpacedRoom(room, publisher, time, on_turn=watchdog.feed)
        unpaced.seat_scripts(world.task, skill, settings.seed or 0)
        opened.enter_context(announced(service))
        gc.freeze()
        with watchdog:
            unpaced.run(work_queue, garbled, service.stop)


def _looks(settings: SimSettings) -> World | None:
    """Build the same room to look at more closely, or None; what happens in it is the other's."""
    if settings.quality == "fast":
        return None
    return World.build(settings.task, settings.control_hz, settings.arms, detail="detailed")


def _archive(settings: SimSettings) -> DivergenceArchive:
    return DivergenceArchive(settings.diverged_dir, settings.room, clock.wall_ns)


def _keeper(settings: SimSettings) -> Callable[[SavedRoom], None]:
    return lambda record: saved_room.save(settings.room_path, record)


def _record(settings: SimSettings) -> SavedRoom:
    record = saved_room.load_or_begin(settings.room_path, settings.task, settings.episodes)
    return record if settings.seed is None else record.with_changes(seed=settings.seed)
