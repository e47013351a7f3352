"""A room around a real world, with time and messages in the test's hands."""

from __future__ import annotations

from collections.abc import Callable

from mart.protocol import codec
from mart.protocol.messages import (
    EPISODE_PHASE_RECORDING,
    OPERATOR_HUMAN,
    Command,
    CommandStamps,
    EpisodeRequest,
    Event,
    RoomStatus,
    SeatRequest,
    State,
    pose_message,
)
from mart.sim.room.driven_arms import DrivenArms
from mart.sim.room.episode_state_machine import Terms
from mart.sim.room.room import Room
from mart.sim.room.saved_room import SavedRoom
from mart.sim.world import Diverged, World

ARMS = ("arm0", "arm1")
PERIOD_S = 0.05


class CapturingPublisher:
    """A voice whose words are kept."""

    def __init__(self) -> None:
        self.states: list[State] = []
        self.statuses: list[RoomStatus] = []
        self.events: list[Event] = []
        self.repeats = 0

    def state(self, state: State) -> None:
        self.states.append(state)

    def repeat_state(self) -> None:
        self.repeats += 1

    def status(self, status: RoomStatus) -> None:
        self.statuses.append(status)

    def event(self, event: Event) -> None:
        self.events.append(event)

    def of(self, what: str) -> list[Event]:
        return [event for event in self.events if event.WhichOneof("what") == what]


class RoomHarness:
    """A room, two people who take seats, and the time."""

    def __init__(
        self,
        world: World,
        record: SavedRoom | None = None,
        explain: Callable[[Diverged], str] = str,
        terms: Terms = Terms(),  # noqa: B008 - frozen
        drivers: DrivenArms | None = None,
    ) -> None:
        self.world = world
        self.publisher = CapturingPublisher()
        self.kept: list[SavedRoom] = []
        self.now_s = 1000.0
        self.room = Room(
            "room-1",
            world,
            record or SavedRoom(seed=1),
            self.publisher,
            self.kept.append,
            now_s=self.now_s,
            explain=explain,
            terms=terms,
            drivers=drivers,
        )
        self._sequence = 0

    @property
    def newest(self) -> State:
        return self.publisher.states[-1]

    def status(self) -> RoomStatus:
        return self.room.status(self.now_s)

    def take(self, arm: str, holder_id: str = "") -> None:
        claim = SeatRequest.Claim(arm=arm, holder_id=holder_id or arm, name="Ana", operator=OPERATOR_HUMAN)
        assert not self.room.answer_seat(SeatRequest(claim=claim), self.now_s).error.code

    def ask(self, request: EpisodeRequest) -> str:
        """The error's code, empty where there is none."""
        return self.room.answer_episode(request, self.now_s).error.code

    def ready(self) -> None:
        for arm in ARMS:
            ready = EpisodeRequest.Ready(arm=arm, holder_id=arm, ready=True)
            assert self.ask(EpisodeRequest(ready=ready)) == ""

    def command(
        self,
        arm: str,
        x_m: float = 0.0,
        gripper: float = 0.0,
        *,
        stop: bool = False,
        state_tick: int = 0,
        sent_s: float | None = None,
    ) -> None:
        """The tool is to go `x_m` from where it is; `sent_s`: when it was said, where it says so."""
        self._sequence += 1
        target = pose_message(self.world.tool_pose_in_base(arm))
        target.x += x_m
        command = Command(
            arm=arm,
            seat_epoch=next(seat.epoch for seat in self.status().seats if seat.arm == arm),
            sequence=self._sequence,
            target_tool_in_base=target,
            gripper=gripper,
            engaged=True,
            emergency_stop=stop,
            state_tick=state_tick,
            stamps=CommandStamps(sent_ns=0 if sent_s is None else round(sent_s * 1e9)),
        )
        self.room.hear(codec.encode(command), arm, self.now_s, round(self.now_s * 1e9))

    def pass_time(self, elapsed_s: float) -> None:
        """Follows the room's own advice about when to call it."""
        end_s = self.now_s + elapsed_s
        while True:
            next_s = self.room.advance(self.now_s)
            if next_s > end_s:
                break
            self.now_s = next_s
        self.now_s = end_s

    def drive(self, ticks: int, x_m: float = 0.0) -> None:
        for _ in range(ticks):
            for arm in ARMS:
                self.command(arm, x_m)
            self.pass_time(PERIOD_S)

    def record(self) -> None:
        """Into the recording of an episode, with both seats taken by people."""
        for arm in ARMS:
            self.take(arm)
        self.drive(2)
        self.ready()
        for _ in range(35):
            for arm in ARMS:
                self.command(arm)
            self.pass_time(0.1)
        assert self.status().episode.phase == EPISODE_PHASE_RECORDING
