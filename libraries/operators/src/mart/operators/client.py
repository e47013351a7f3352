"""Drive seats from a program of your own, beside people: the whole way from an operator to a moving arm."""

from __future__ import annotations

import contextlib
import secrets
import threading
from collections.abc import Callable, Mapping, Sequence

from mart.operators.claim import ClaimedSeats, claimed_seats
from mart.operators.commander import SeatCommander
from mart.operators.driver import SeatDriver, SeatSelection
from mart.operators.episode_follower import EpisodeFollower
from mart.operators.operator import Operator
from mart.operators.room_client import RoomClient
from mart.operators.time_limit import TimeLimitedOperator
from mart.protocol import clock
from mart.protocol.control_rate import ticks_for_each
from mart.protocol.errors import Conflict, InvalidInput, Unavailable
from mart.protocol.messages import OPERATOR_HOLD, OPERATOR_SCRIPT, RoomStatus, operator_from_word
from mart.protocol.messages import Operator as OperatorOnWire
from mart.protocol.room_task import task_of_room
from mart.protocol.vocabulary import EpisodeOutcome, OperatorKind, ServiceKind
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.service import Service, announced, stop_requested
from mart.runtime.settings import Settings

ROOM_SILENCE_S = 60.0  # a room that is started anew takes a moment, and remembers who sat where
_ASK_AGAIN_S = 1.0


def drive_seats(
    operator: Operator,
    room: str = "room-1",
    arms: Sequence[str] = ("arm0",),
    *,
    name: str = "operator",
    kind: OperatorKind = OperatorKind.POLICY,
    episodes: int | None = None,
    fill_with_scripts: bool = False,
    time_limit_s: float = 2.0,
    control_hz: float | None = None,
    router: str | None = None,
    stop: threading.Event | None = None,
) -> list[EpisodeOutcome]:
    """Take the seats of `arms` in `room` and let `operator` drive them, beside people, scripts and policies.

    `name` is what others see. `kind` is who drives: a policy, or a human whose input device the operator reads; files
    and partners are told so. People may take over from a policy and hand back. With `episodes`, the operator says that
    it is ready whenever the room practises, and the call returns the outcomes of that many; without, it drives until
    Ctrl-C, or until `stop` is set, and returns the outcomes of what was recorded meanwhile. `fill_with_scripts` gives
    seats that nobody holds to scripted experts. `control_hz` is how often a second the operator acts, in rooms of that
    rate or a multiple; None: at every tick of the room. `router` is where the platform's router listens; None:
    MART_ROUTER, or this machine.

    Raises InvalidInput for another kind than policy and human, for a room whose rate is no multiple of `control_hz`, or
    where the operator fails or says what is no target;
    Conflict where somebody else sits there or the last seat was given to another; NotFound for an unknown arm;
    Unavailable where room or router cannot be reached, or where the operator takes longer than `time_limit_s` seconds
    for one tick. The seats are left in every case.

    >>> drive_seats(Riser(), arms=["arm1"], episodes=1)  # doctest: +SKIP
    [<EpisodeOutcome.SUCCESS: 'success'>]
    """
    holder_id = secrets.token_hex(16)
    called = f"operate-{secrets.token_hex(8)}"  # everybody sees it: another one
    with contextlib.ExitStack() as stack:
        stop = stop or stack.enter_context(stop_requested())
        bus = stack.enter_context(ZenohBus.connect(router or Settings().router))
        stack.enter_context(announced(Service(ServiceKind.OPERATE, called, bus, stop)))
        client = RoomClient(bus, room)
        source = _source(kind)
        limited = TimeLimitedOperator(operator, time_limit_s)
        limited.prepare()
        seats = stack.enter_context(claimed_seats(client, arms, holder_id, name, source))
        selection = ProgramSeats(seats, name, _maker(limited, arms, source, control_hz))
        session = _Session(client, arms[0], holder_id, episodes, fill_with_scripts)
        drive_claimed(SeatDriver(bus, room, selection), seats, room, stop, session.follow)
        return session.outcomes


def drive_claimed(
    driver: SeatDriver[str],
    seats: ClaimedSeats,
    room: str,
    stop: threading.Event,
    follow: Callable[[RoomStatus], bool] | None = None,
) -> None:
    """Drive until `stop` is set or `follow`, which is told each status, returns False.

    Raises what made the operator leave, and Conflict where all seats went to others. While a person has taken over it
    waits for the seat.
    """
    with contextlib.closing(driver):
        while not stop.is_set():
            status = driver.work().get(room)
            if driver.failure is not None:
                raise driver.failure
            if not seats:
                raise Conflict(f"The seat in {room} was given away or left; take one again when it is free.")
            if status is not None and follow is not None and not follow(status):
                return
            if clock.monotonic_s() - driver.heard_s > ROOM_SILENCE_S:
                raise Unavailable(f"{room} has said nothing for {ROOM_SILENCE_S:g} s; see `mart rooms`.")


class ProgramSeats(SeatSelection[str]):
    """Assign the seats that were claimed for one program to it."""

    kind = ServiceKind.OPERATE

    def __init__(
        self, seats: ClaimedSeats, name: str, make: Callable[[RoomStatus], Sequence[SeatCommander]]
    ) -> None:
        self._seats, self._name, self._make = seats, name, make

    def assigned(self, room: str, status: RoomStatus) -> Mapping[str, Mapping[str, int]]:
        """Return the seats that are held now; see `SeatSelection`."""
        epochs = self._seats.held(status)
        return {self._name: epochs} if epochs else {}

    def commanders(self, key: str, status: RoomStatus) -> Sequence[SeatCommander]:
        """Return the program's commanders; see `SeatSelection`."""
        return self._make(status)

    def name_of(self, key: str) -> str:
        """Return the program's name; see `SeatSelection`."""
        return key


class _Session:
    """Fills seats and says ready, as often as it takes: what a room did not hear is said again."""

    def __init__(
        self, client: RoomClient, arm: str, holder_id: str, episodes: int | None, fill_with_scripts: bool
    ) -> None:
        self._client, self._arm, self._holder_id = client, arm, holder_id
        self._episodes, self._fills = episodes, fill_with_scripts
        self._follower = EpisodeFollower(arm)
        self._ask_s = 0.0

    @property
    def outcomes(self) -> list[EpisodeOutcome]:
        return self._follower.outcomes

    def follow(self, status: RoomStatus) -> bool:
        """Take note of a status; returns whether there is more to do."""
        should_be_ready = self._follower.follow(status)
        if self._episodes is not None and len(self.outcomes) >= self._episodes:
            return False
        now_s = clock.monotonic_s()
        if now_s >= self._ask_s:
            self._ask_s = now_s + _ASK_AGAIN_S
            self._ask(status, should_be_ready)
        return True

    def _ask(self, status: RoomStatus, should_be_ready: bool) -> None:
        empty = [seat.arm for seat in status.seats if seat.operator == OPERATOR_HOLD] if self._fills else []
        with contextlib.suppress(Conflict, Unavailable):  # the room moved on; the next status tells
            for arm in empty:
                self._client.assign(arm, OPERATOR_SCRIPT)
            if should_be_ready and self._episodes is not None and not empty:
                self._client.ready(self._arm, self._holder_id)


def _source(kind: OperatorKind) -> OperatorOnWire:
    if kind not in (OperatorKind.POLICY, OperatorKind.HUMAN):
        raise InvalidInput(f"A program was to drive as {kind}; it may drive as policy or human.")
    return operator_from_word(kind)


def _maker(
    operator: Operator, arms: Sequence[str], source: OperatorOnWire, control_hz: float | None
) -> Callable[[RoomStatus], Sequence[SeatCommander]]:
    def make(status: RoomStatus) -> Sequence[SeatCommander]:
        task = task_of_room(status)
        each = 1 if control_hz is None else ticks_for_each(control_hz, status.control_hz)
        return [SeatCommander(operator, task, arms, source, act_every_ticks=each)]

    return make
