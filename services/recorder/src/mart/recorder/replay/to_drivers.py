"""Send an episode's recorded way to the drivers of a room: look, say what will move, lead, and leave."""

from __future__ import annotations

import contextlib
import secrets
import threading
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mart.episodes.reader import EpisodeFile
from mart.operators import Operator, RoomClient
from mart.operators.claim import claimed_seats
from mart.operators.client import ProgramSeats, drive_claimed
from mart.operators.commander import SeatCommander
from mart.operators.driver import SeatDriver
from mart.operators.room_watch import RoomWatch
from mart.protocol import clock, codec, keys
from mart.protocol.errors import Conflict, InvalidInput, MartError, Unavailable
from mart.protocol.messages import OPERATOR_POLICY, Model, RoomStatus, State, pose_from_message
from mart.protocol.room_task import task_of_room
from mart.protocol.tasks import Task, get_task
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.replay.ends import EndWatch, objection_to_room
from mart.recorder.replay.led_way import LedWay, RecordedWay, StandingArm, joint_observation, require_near
from mart.recorder.replay.same_arm import require_same_arm, require_same_kind, require_same_task
from mart.recorder.replay.way_operator import WayOperator
from mart.render.compiled_model import load_model
from mart.runtime.bus import Bus
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.runtime.service import Service, announced

_NAME = "replay"
_TIMEOUT_S = 5.0
_LOOK_S = 0.2


@dataclass(frozen=True)
class Replay:
    """Hold what would be done: in which room, with which arms and drivers, and along which way."""

    room: str
    control_hz: float
    drivers: dict[str, str]  # by arm, what people call its driver
    led: LedWay


@dataclass(frozen=True)
class Replayed:
    """Tell how a replay ended. led_s: of the way's time; why: it ended before its end, a sentence; else empty."""

    led_s: float
    why: str


def prepare(bus: Bus, file: EpisodeFile, room: str, arms: Sequence[str], speed: float) -> Replay:
    """Look at file and room, and return what a replay would do; nothing moves. arms: none, all that drivers drive.

    Raises InvalidInput, NotFound and Corrupt for a file or a room that do not fit together, Conflict where the room is
    stopped, in an episode, or an arm stands too far off, and Unavailable where the room cannot be reached.
    """
    status, state = _look(bus, room)
    recorded, present = _task_of(file), task_of_room(status)
    drivers = {driven.arm: driven.driver for driven in status.driven_arms}
    wanted = tuple(arms) or tuple(arm for arm in recorded.arm_names if arm in drivers)
    if not wanted or not set(wanted) <= drivers.keys():
        lacking = ", ".join(arm for arm in wanted if arm not in drivers) or ", ".join(recorded.arm_names)
        raise InvalidInput(
            f"No driver drives {lacking} of {room}; drivers drive {', '.join(drivers) or 'none'} there. "
            "`mart run --driver` says which arms are real."
        )
    require_same_task(recorded, present, room)
    for arm in wanted:
        require_same_kind(arm, recorded, present, room)
    _require_same_arms(bus, file, room, wanted)
    objection = objection_to_room(status, wanted)
    if objection or state is None:
        raise Conflict(objection or f"{room} has not said yet where its arms are; try again.")
    way = RecordedWay.of(file.arrays(recorded), wanted)
    stands = _stands(state, wanted)
    require_near(way, stands)
    led = LedWay(way, {arm: stand.tool_in_base for arm, stand in stands.items()}, speed)
    return Replay(room, status.control_hz, {arm: drivers[arm] for arm in wanted}, led)


def lead(bus: Bus, replay: Replay, stop: threading.Event) -> Replayed:
    """Lead the arms until the way is over, `stop` is set, or anything stops the room; the seats are left in any case.

    `stop` is set at the end in any case.
    """
    arms, holder_id = tuple(replay.drivers), secrets.token_hex(16)
    watch = EndWatch(arms, holder_id)
    finished = threading.Event()

    def heard(status: RoomStatus) -> None:
        watch.hear(status)
        if watch.why:
            stop.set()

    def done() -> None:
        finished.set()
        stop.set()

    operator = WayOperator(replay.led.recorded, replay.led.speed, replay.control_hz, done)
    why = ""
    subscription = bus.subscribe(keys.status(replay.room).key, DecodingSubscriber(RoomStatus, heard))
    with contextlib.closing(subscription):
        try:
            _drive(bus, replay, holder_id, operator, stop)
        except MartError as error:
            why = str(error)
    stop.set()
    why = watch.why or why or ("" if finished.is_set() else "It was asked to end.")
    return Replayed(operator.time_s, why)


def _drive(bus: Bus, replay: Replay, holder_id: str, operator: Operator, stop: threading.Event) -> None:
    room, arms = replay.room, tuple(replay.drivers)

    def commanders(status: RoomStatus) -> Sequence[SeatCommander]:
        return [SeatCommander(operator, task_of_room(status), arms, OPERATOR_POLICY)]

    service = Service(ServiceKind.OPERATE, f"replay-{secrets.token_hex(8)}", bus, stop)
    with announced(service), claimed_seats(RoomClient(bus, room), arms, holder_id, _NAME) as seats:
        drive_claimed(SeatDriver(bus, room, ProgramSeats(seats, _NAME, commanders)), seats, room, stop)


def _look(bus: Bus, room: str) -> tuple[RoomStatus, State | None]:
    """Return a room's newest status, and its newest state where one came."""
    deadline_s = clock.monotonic_s() + _TIMEOUT_S
    status, state = None, None
    with contextlib.closing(RoomWatch(bus, room)) as watch:
        while (status is None or state is None) and clock.monotonic_s() < deadline_s:
            statuses, states = watch.take(_LOOK_S)
            status, state = statuses.get(room, status), states.get(room, state)
            if status is not None and status.HasField("stop"):
                break
    if status is None:
        raise Unavailable(
            f"{room} was not heard within {_TIMEOUT_S:g} s; `mart rooms` lists those that are there."
        )
    return status, state


def _task_of(file: EpisodeFile) -> Task:
    episode = file.episode
    return get_task(episode.task or "", len(episode.arms), episode.arm_kinds)


def _require_same_arms(bus: Bus, file: EpisodeFile, room: str, arms: Sequence[str]) -> None:
    present = codec.decode(Model, bus.query(keys.model(room), b"", _TIMEOUT_S))
    record = file.room
    if record.model_sha256 == present.sha256:
        return
    sha256, version = record.model_sha256 or "", record.mujoco_version or "an unknown version"
    was = load_model(file.model(), sha256=sha256, mujoco_version=version, source=str(file.path))
    is_now = load_model(
        present.mjb, sha256=present.sha256, mujoco_version=present.mujoco_version, source=room
    )
    for arm in arms:
        require_same_arm(arm, was, is_now, room)


def _stands(state: State, arms: Sequence[str]) -> dict[str, StandingArm]:
    poses = {arm.arm: pose_from_message(arm.tool_in_base) for arm in state.arms}
    joints = {one.name: np.array(one.value) for one in state.observations}
    return {arm: StandingArm(poses[arm], joints[joint_observation(arm)]) for arm in arms}
