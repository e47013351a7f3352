"""Serve a room: settings in, a running sim until it is asked to stop."""

from __future__ import annotations

import contextlib
import gc
import logging
from collections import Counter
from collections.abc import Callable
from functools import partial

from mart.protocol import clock, keys
from mart.protocol.cameras import arm_of_camera
from mart.protocol.control_rate import DEFAULT_CONTROL_HZ
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import Event, RoomStatus
from mart.protocol.practice import require_practice_alone
from mart.protocol.tasks import arm_kinds_of
from mart.protocol.vocabulary import OperatorKind, ServiceKind
from mart.runtime.bus import Bus, Closable
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.runtime.service import announced, connected
from mart.runtime.skill_option import parse_people
from mart.runtime.throttled_log import ThrottledLog
from mart.runtime.watchdog import Watchdog
from mart.sim.room import saved_room
from mart.sim.room.automatic_rate import AutomaticRate
from mart.sim.room.bus_drivers import BusDrivers
from mart.sim.room.bus_publisher import BusPublisher, OrderedPublisher
from mart.sim.room.calibration import measure
from mart.sim.room.driven_arms import DrivenArms
from mart.sim.room.episode_state_machine import Terms
from mart.sim.room.live_room import LiveRoom, MakeRoom
from mart.sim.room.rate_watch import RateWatch
from mart.sim.room.room import Room
from mart.sim.room.room_metrics import MeteredPublisher
from mart.sim.room.room_publisher import RoomPublisher
from mart.sim.room.room_server import RoomServer
from mart.sim.room.saved_room import SavedRoom
from mart.sim.room.serial_executor import SerialExecutor
from mart.sim.room.unpaced_room import SimulatedTime, UnpacedRoom
from mart.sim.room.work_queue import WorkQueue
from mart.sim.settings import SimSettings
from mart.sim.world import World
from mart.sim.world.beginnings import require_sound_beginnings
from mart.sim.world.divergence import DivergenceArchive
from mart.sim.world.driven_world import DrivenWorld
from mart.sim.world.reach import require_reach

_log = logging.getLogger(__name__)

DEFAULT_SKILL = "expert"


def serve_room(settings: SimSettings) -> None:
    """Build the world of `settings` and serve its room.

    Raises what building a world raises, NotFound for an unknown skill, and InvalidInput for a practice room that is to
    count or to run by itself, or for arms that do not reach what the task asks of them;
    NotFound for a camera of an arm that the task does not have.
    """
    require_practice_alone(
        practice=settings.practice,
        course_required=settings.course_required,
        episodes=settings.episodes or 0,
        lockstep=settings.lockstep,
    )
    world = World.build(
        settings.task, settings.control_hz or DEFAULT_CONTROL_HZ, settings.arms, kinds=_arm_kinds(settings)
    )
    require_reach(world)
    require_sound_beginnings(world)
    _require_arms_of(settings.cameras, world)
    if settings.drivers:
        serve_driven(settings, world)
    elif settings.lockstep:
        serve_unpaced(settings, world, settings.skill or DEFAULT_SKILL)
    else:
        serve_world(settings, world)


def _require_arms_of(cameras: tuple[str, ...], world: World) -> None:
    """Raise NotFound for a camera of a seat that the task does not have."""
    for arm in filter(None, map(arm_of_camera, cameras)):
        world.task.arm(arm)


def serve_driven(settings: SimSettings, world: World) -> None:
    """Serve the room with drivers of real arms around a simulated world; its rate is as given, else 20 Hz.

    Raises InvalidInput in lockstep, NotFound for an arm that the task does not have.
    """
    if settings.lockstep:
        raise InvalidInput(
            "Drivers were given to a room in lockstep: real arms take their time; leave out one."
        )
    link = BusDrivers(settings.room, world, settings.drivers)
    serve_world(settings.model_copy(update={"control_hz": world.control_hz}), DrivenWorld(world, link), link)


def serve_world(settings: SimSettings, world: World, drivers: BusDrivers | None = None) -> None:
    """Serve the room of `settings` around a world that exists already; its rate is as given or found to be held."""
    record = _record(settings)
    rate = _automatic_rate(settings, world, record) if settings.control_hz is None else None
    if rate is not None:
        world = world.at(rate.control_hz)
        _log.info("%s ticks %g times a second, as nobody gave a rate", settings.room, rate.control_hz)
    with connected(settings, ServiceKind.SIM, settings.room) as service, contextlib.ExitStack() as opened:
        publisher: RoomPublisher = opened.enter_context(
            contextlib.closing(BusPublisher(service.bus, settings.room))
        )
        publisher = MeteredPublisher(publisher, settings.room, world.arms)
        if rate is not None:
            publisher = RateWatch(publisher, rate, clock.monotonic_s)
        if drivers is not None:
            opened.enter_context(contextlib.closing(drivers.publish_on(service.bus)))
        make = _maker(settings, publisher, drivers)
        live = LiveRoom(world, record, make, _keeper(settings), clock.monotonic_s(), rate=rate)
        throttled_log, garbled = ThrottledLog(_log), Counter[str]()
        watchdog = Watchdog(f"The room {settings.room}")

        def advance(now_s: float) -> float:
            watchdog.feed()
            next_s = live.advance(now_s)
            throttled_log.report(live.rejected + garbled, now_s)
            return next_s

        executor = SerialExecutor(advance)
        server = RoomServer(
            service.bus,
            settings.room,
            live.room,
            world,
            submit=executor.submit,
            leave=executor.leave,
            garbled=garbled,
            looks=_looks(settings),
        )
        opened.enter_context(contextlib.closing(server))
        live.serve_by(server)
        if rate is not None:
            opened.enter_context(contextlib.closing(_hear_pictures(service.bus, settings, rate, executor)))
        server.hear_commands()
        opened.enter_context(announced(service))
        gc.freeze()  # what is here now stays: later collections need not look at it
        with watchdog:
            executor.run(service.stop)


def serve_unpaced(settings: SimSettings, world: World, skill: str) -> None:
    """Serve the same room on simulated time, with its scripts. skill: of all of them, or one for each arm."""
    people = parse_people(skill, len(world.arms))
    with connected(settings, ServiceKind.SIM, settings.room) as service, contextlib.ExitStack() as opened:
        work_queue, garbled, time = WorkQueue(), Counter[str](), SimulatedTime()
        publisher = OrderedPublisher(service.bus, settings.room, world.arms)
        opened.enter_context(contextlib.closing(publisher))
        terms = Terms(lockstep=True, skill=skill, time_limit_s=settings.time_limit_s)
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
        unpaced.seat_scripts(world.task, people, settings.seed or 0)
        opened.enter_context(announced(service))
        gc.freeze()
        with watchdog:
            unpaced.run(work_queue, garbled, service.stop)


def _automatic_rate(settings: SimSettings, world: World, record: SavedRoom) -> AutomaticRate:
    return AutomaticRate(
        measure(world),
        len(world.arms),
        clock.monotonic_s(),
        pace=settings.pace,
        picture_s=record.picture_s,
        policies=any(one.operator is OperatorKind.POLICY or one.relieved for one in record.seats),
    )


def _hear_pictures(
    bus: Bus, settings: SimSettings, rate: AutomaticRate, executor: SerialExecutor
) -> Closable:
    """Let the rate see what seats say their pictures take, until what is returned is closed."""

    def take(event: Event) -> None:
        if event.HasField("picture_cost"):
            cost = event.picture_cost
            executor.leave(partial(rate.see_picture, cost.arm, cost.picture_ms * 1e-3))

    return bus.subscribe(keys.event(settings.room).key, DecodingSubscriber(Event, take))


def _maker(settings: SimSettings, publisher: RoomPublisher, drivers: DrivenArms | None) -> MakeRoom:
    terms = Terms(
        skill=settings.skill or "",
        time_limit_s=settings.time_limit_s,
        practice=settings.practice,
        cameras=settings.cameras,
    )
    archive = _archive(settings)

    def make(
        world: World,
        record: SavedRoom,
        keep: Callable[[SavedRoom], None],
        now_s: float,
        before: RoomStatus,
    ) -> Room:
        return Room(
            settings.room,
            world,
            record,
            publisher,
            keep,
            now_s=now_s,
            pace=settings.pace,
            before=before,
            terms=terms,
            explain=archive.keep,
            drivers=drivers,
        )

    return make


def _looks(settings: SimSettings) -> World | None:
    """Build the same room to look at more closely, or None; what happens in it is the other's."""
    if settings.quality == "fast":
        return None
    hz = settings.control_hz or DEFAULT_CONTROL_HZ  # shown, never stepped
    return World.build(settings.task, hz, settings.arms, "detailed", _arm_kinds(settings))


def _arm_kinds(settings: SimSettings) -> tuple[str, ...]:
    return arm_kinds_of(settings.task, settings.arms, settings.arm_kinds)


def _archive(settings: SimSettings) -> DivergenceArchive:
    return DivergenceArchive(settings.diverged_dir, settings.room, clock.wall_ns)


def _keeper(settings: SimSettings) -> Callable[[SavedRoom], None]:
    return lambda record: saved_room.save(settings.room_path, record)


def _record(settings: SimSettings) -> SavedRoom:
    record = saved_room.load_or_begin(
        settings.room_path, settings.task, settings.episodes, course_required=settings.course_required
    )
    return record if settings.seed is None else record.with_changes(seed=settings.seed)
