"""Receive everything that comes from the bus for one room."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable
from functools import partial

from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput, MartError
from mart.protocol.messages import (
    ArmMeasured,
    CameraReport,
    DriverHello,
    DriverReply,
    EpisodeRequest,
    Event,
    RecordingReport,
    RoomReply,
    SeatRequest,
)
from mart.protocol.queryables import DRIVER, EPISODE, SEAT
from mart.protocol.received import decode_received, require_room
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus, Closable, Request, Sample
from mart.runtime.serving import RequestAnswerer, send_reply
from mart.sim.room.room import Room
from mart.sim.room.save_follower import SaveFollower
from mart.sim.world import World
from mart.sim.world.model_message import model_message

_log = logging.getLogger(__name__)

_MAX_REPORT_BYTES = 1024
_MAX_MEASURED_BYTES = 8192


class RoomServer:
    """Turn what comes in into work for the room, which `submit` does now or later; never do any by itself.

    leave: takes work from a thread that hears what the room says, and so must not do it. garbled: counts undecodable
    payloads by where they came. looks: the same world with detailed meshes, to show.
    """

    def __init__(
        self,
        bus: Bus,
        name: str,
        room: Room,
        world: World,
        *,
        submit: Callable[[Callable[[], None]], None],
        leave: Callable[[Callable[[], None]], None],
        garbled: Counter[str],
        now_s: Callable[[], float] = clock.monotonic_s,
        looks: World | None = None,
    ) -> None:
        self._bus, self._name, self._now_s = bus, name, now_s
        self._room = room
        self._submit, self._leave, self._garbled = submit, leave, garbled
        self._looks = looks
        self.show(world)
        self._seat = RequestAnswerer(SEAT, self._answer_seat, self._on_refused)
        self._episode = RequestAnswerer(EPISODE, self._answer_episode, self._on_refused)
        self._driver = RequestAnswerer(DRIVER, self._answer_driver, self._on_refused_driver)
        self._open: list[Closable] = [
            SaveFollower(bus, name, self._on_saved, garbled, room.unsaved),
            bus.subscribe(keys.recording(name).key, self._on_recording_report),
            bus.watch(keys.alive_of(ServiceKind.RECORDER), self._on_recorder_alive),
            bus.watch(keys.alive_of(ServiceKind.CAMERA), self._on_camera_alive),
            bus.serve(keys.seat(name), self._on_seat_request),
            bus.serve(keys.episode(name), self._on_episode_request),
            bus.serve(keys.model(name), self._on_model_request),
            bus.serve(keys.driver(name), self._on_driver_hello),
            *(
                bus.subscribe(keys.arm_measured(name, arm).key, self._on_measured)
                for arm in room.drivers.arms
            ),
            *(
                bus.subscribe(keys.camera_report(name, camera).key, self._on_camera)
                for camera in room.cameras.names
            ),
        ]

    def show(self, world: World) -> None:
        """Answer with the model of this world from now on, in which no room needs to run yet."""
        looks = self._looks.at(world.control_hz) if self._looks is not None else world
        self._models = {
            what: codec.encode(model_message(shown)) for what, shown in ((b"", world), (keys.DETAILED, looks))
        }

    def use(self, room: Room) -> None:
        """Do all work for this room from now on. It must have said nothing before its world was shown."""
        self._room = room

    def hear_commands(self) -> None:
        """Receive the commands of operators in other processes too."""
        self._open.append(self._bus.subscribe(keys.commands(self._name), self._on_command))

    def close(self) -> None:
        """Withdraw everything from the bus."""
        for declared in self._open:
            declared.close()

    def _on_command(self, sample: Sample) -> None:
        payload, arm, at_s, at_wall_ns = (
            sample.payload, keys.arm_of(sample.key), self._now_s(), clock.wall_ns()
        )  # fmt: skip
        self._submit(lambda: self._room.hear(payload, arm, at_s, at_wall_ns))

    def _on_measured(self, sample: Sample) -> None:
        now_s = self._now_s()
        try:
            measured = decode_received(ArmMeasured, sample.payload, _MAX_MEASURED_BYTES)
            require_room(measured, sample.key)
        except InvalidInput:
            self._garbled["measured arm"] += 1
        else:
            self._submit(lambda: self._room.drivers.hear(measured, now_s))

    def _on_camera(self, sample: Sample) -> None:
        now_s = self._now_s()
        try:
            report = decode_received(CameraReport, sample.payload, _MAX_REPORT_BYTES)
            require_room(report, sample.key)
        except InvalidInput:
            self._garbled["camera report"] += 1
        else:
            self._leave(lambda: self._hear_camera(report, now_s))

    def _hear_camera(self, report: CameraReport, now_s: float) -> None:
        self._room.cameras.hear(report, now_s)
        for event in self._room.cameras.news(now_s):
            self._room.tell(event)

    def _on_camera_alive(self, key: str, alive: bool) -> None:
        camera = keys.last_of(key).removeprefix(f"{self._name}-")
        if not alive:
            self._leave(lambda: self._lose_camera(camera))

    def _lose_camera(self, camera: str) -> None:
        self._room.cameras.gone(camera, self._now_s())
        for event in self._room.cameras.news(self._now_s()):
            self._room.tell(event)

    def _on_recording_report(self, sample: Sample) -> None:
        try:
            report = decode_received(RecordingReport, sample.payload, _MAX_REPORT_BYTES)
        except InvalidInput:
            self._garbled["recording report"] += 1
        else:
            self._leave(lambda: self._room.recording_watch.reported(report))

    def _on_recorder_alive(self, key: str, alive: bool) -> None:
        if not alive:
            self._leave(lambda: self._room.recording_watch.gone(keys.last_of(key)))

    def _on_saved(self, saved: Event.EpisodeSaved) -> None:
        self._leave(lambda: self._room.episode_saved(saved))

    def _on_seat_request(self, request: Request) -> None:
        self._submit(partial(self._seat.respond, request))

    def _on_episode_request(self, request: Request) -> None:
        self._submit(partial(self._episode.respond, request))

    def _on_model_request(self, request: Request) -> None:
        models = self._models
        send_reply(request, models.get(request.payload, models[b""]))

    def _on_driver_hello(self, request: Request) -> None:
        self._submit(partial(self._driver.respond, request))

    def _answer_driver(self, hello: DriverHello) -> DriverReply:
        return self._room.drivers.hello(hello, self._now_s())

    def _on_refused_driver(self, error: MartError) -> None:
        self._garbled["driver"] += 1
        _log.warning("%s", error)

    def _answer_seat(self, request: SeatRequest) -> RoomReply:
        return self._room.answer_seat(request, self._now_s())

    def _answer_episode(self, request: EpisodeRequest) -> RoomReply:
        return self._room.answer_episode(request, self._now_s())

    def _on_refused(self, _error: MartError) -> None:
        self._garbled["request"] += 1
