"""A room that is opened anew at another rate: seats and counts stay, everything that was of the old world goes."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable

import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    OUTCOME_DISCARDED,
    OUTCOME_SUCCESS,
    Command,
    EpisodeRequest,
    Event,
    Model,
    RoomStatus,
    SeatRequest,
    pose_message,
)
from mart.runtime.bus.memory import MemoryNetwork
from mart.sim.room.automatic_rate import LOOK_EVERY_S, AutomaticRate, SimCost
from mart.sim.room.live_room import LiveRoom
from mart.sim.room.rate_watch import RateWatch
from mart.sim.room.room import Room
from mart.sim.room.room_server import RoomServer
from mart.sim.room.saved_room import SavedRoom
from mart.sim.world import World
from tests.sim.room.room_harness import CapturingPublisher

CHEAP = SimCost(physics=0.02, tick_s=0.0005, cores=8)


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting", 60.0)


class Stand:
    """A live room with its time; `rate`: None where it was given."""

    def __init__(self, world: World, *, automatic: bool = True) -> None:
        self.publisher, self.kept, self.now_s = CapturingPublisher(), list[SavedRoom](), 100.0
        self._sequence = 0
        self.rate = AutomaticRate(CHEAP, 2, self.now_s, picture_s=0.002)
        self.heard = RateWatch(self.publisher, self.rate, lambda: self.now_s)
        self.live = LiveRoom(
            world,
            SavedRoom(seed=1, episodes=3),
            self._make,
            self.kept.append,
            self.now_s,
            rate=self.rate if automatic else None,
        )
        self.pass_time(0.5)

    def _make(
        self,
        world: World,
        record: SavedRoom,
        keep: Callable[[SavedRoom], None],
        now_s: float,
        before: RoomStatus,
    ) -> Room:
        return Room("room-1", world, record, self.heard, keep, now_s=now_s, before=before)

    def claim(self, arm: str, operator: int = OPERATOR_HUMAN) -> int:
        kind = OPERATOR_POLICY if operator == OPERATOR_POLICY else OPERATOR_HUMAN
        claim = SeatRequest.Claim(arm=arm, holder_id=arm, name="Ana", operator=kind)
        return self.live.room.answer_seat(SeatRequest(claim=claim), self.now_s).seat.epoch

    def pass_time(self, elapsed_s: float) -> None:
        end_s = self.now_s + elapsed_s
        while self.now_s < end_s:
            self.now_s = min(max(self.live.advance(self.now_s), self.now_s + 1e-4), end_s)

    def command(self, arm: str) -> None:
        """The tool is to stay where it is."""
        self._sequence += 1
        epoch = next(s.epoch for s in self.live.room.status(self.now_s).seats if s.arm == arm)
        target = pose_message(self.live.world.tool_pose_in_base(arm))
        command = Command(arm=arm, seat_epoch=epoch, sequence=self._sequence, target_tool_in_base=target)
        self.live.room.hear(codec.encode(command), arm, self.now_s, round(self.now_s * 1e9))

    def slow_pictures(self) -> None:
        for arm in ("arm0", "arm1"):
            self.rate.see_picture(arm, 0.1)


def test_seats_counts_and_ticks_go_on_in_another_world(world: World) -> None:
    stand = Stand(world)
    epoch = stand.claim("arm0")
    saved = Event.EpisodeSaved(number=3, verified=True, outcome=OUTCOME_SUCCESS)
    stand.live.room.episode_saved(saved)
    before = stand.live.room.status(stand.now_s)
    stand.slow_pictures()
    stand.pass_time(LOOK_EVERY_S + 0.2)
    after = stand.publisher.statuses[-1]
    assert (before.control_hz, after.control_hz) == (60.0, 30.0)
    assert after.boot != before.boot
    assert after.seats[0].operator == OPERATOR_HUMAN
    assert after.seats[0].epoch == epoch
    assert (after.episodes_saved, after.episodes_good, after.episode.number) == (1, 1, 3)
    ticks = [state.tick for state in stand.publisher.states]
    assert ticks == list(range(1, len(ticks) + 1))
    assert stand.kept[-1].seats[0].holder_id == "arm0"
    told = [event.notice.text for event in stand.publisher.of("notice")]
    assert told == ["The room now ticks 30 times a second: pictures take 100 ms of each tick."]


def test_how_an_episode_ended_is_said_on(world: World) -> None:
    """It is abandoned: one status between the episode and practice in another world, which may be lost."""
    stand = Stand(world)
    stand.claim("arm0")
    ready = EpisodeRequest.Ready(arm="arm0", holder_id="arm0", ready=True)
    stand.live.room.answer_episode(EpisodeRequest(ready=ready), stand.now_s)
    stand.pass_time(0.1)
    while stand.publisher.statuses[-1].episode.phase != EPISODE_PHASE_RECORDING:
        stand.command("arm0")
        stand.pass_time(0.1)
    stand.slow_pictures()
    reset = EpisodeRequest.Reset(holder_id="arm0")
    stand.live.room.answer_episode(EpisodeRequest(reset=reset), stand.now_s)
    stand.pass_time(0.2)
    status = stand.publisher.statuses[-1]
    assert (status.control_hz, status.episode.phase) == (30.0, EPISODE_PHASE_PRACTICE)
    assert (status.last_ended.number, status.last_ended.outcome) == (4, OUTCOME_DISCARDED)


def test_what_pictures_took_is_known_after_a_restart(world: World) -> None:
    stand = Stand(world)
    stand.slow_pictures()
    stand.claim("arm0")
    assert stand.kept[-1].picture_s == 0.1


def test_a_policys_seat_is_first_told_at_a_rate_that_suits_it(world: World) -> None:
    stand = Stand(world)
    stand.slow_pictures()
    stand.pass_time(LOOK_EVERY_S + 0.2)
    assert stand.publisher.statuses[-1].control_hz == 30.0
    told = len(stand.publisher.statuses)
    stand.claim("arm1", OPERATOR_POLICY)
    stand.pass_time(0.2)
    with_it = [s for s in stand.publisher.statuses[told:] if s.seats[1].operator == OPERATOR_POLICY]
    assert {status.control_hz for status in with_it} == {20.0}


def test_an_episode_that_was_just_asked_for_is_not_lost(world: World) -> None:
    """The room has said nothing since: what it told last is that it practises."""
    stand = Stand(world)
    stand.claim("arm0")
    stand.slow_pictures()
    stand.now_s += LOOK_EVERY_S
    ready = EpisodeRequest.Ready(arm="arm0", holder_id="arm0", ready=True)
    assert not stand.live.room.answer_episode(EpisodeRequest(ready=ready), stand.now_s).error.code
    stand.pass_time(0.5)
    status = stand.publisher.statuses[-1]
    assert (status.episode.phase, status.control_hz) == (EPISODE_PHASE_COUNTDOWN, 60.0)


def test_a_rate_that_was_given_stays(world: World) -> None:
    stand = Stand(world, automatic=False)
    stand.slow_pictures()
    stand.pass_time(LOOK_EVERY_S + 0.2)
    assert {status.control_hz for status in stand.publisher.statuses} == {60.0}
    assert stand.publisher.of("notice") == []


def test_refused_commands_are_counted_on(world: World) -> None:
    stand = Stand(world)
    stand.live.room.hear(b"\xff", "arm0", stand.now_s, 0)
    stand.slow_pictures()
    stand.pass_time(LOOK_EVERY_S + 0.2)
    stand.live.room.hear(b"\xff", "arm0", stand.now_s, 0)
    assert stand.live.rejected.total() == 2


def test_the_door_answers_with_the_new_model_and_asks_the_new_room(world: World) -> None:
    bus, stand = MemoryNetwork().connect(), Stand(world)
    server = RoomServer(
        bus,
        "room-1",
        stand.live.room,
        world,
        submit=_do,
        leave=_do,
        garbled=Counter(),
        now_s=lambda: stand.now_s,
    )
    with contextlib.closing(server):
        stand.live.serve_by(server)
        stand.slow_pictures()
        stand.pass_time(LOOK_EVERY_S + 0.2)
        model = codec.decode(Model, bus.query(keys.model("room-1"), b"", 1.0))
        assert (model.control_hz, model.sha256) == (30.0, World.build(world.task.name, 30.0).model_sha256)
        reset = EpisodeRequest(reset=EpisodeRequest.Reset())
        states = len(stand.publisher.states)
        bus.query(keys.episode("room-1"), codec.encode(reset), 1.0)
        assert stand.publisher.states[states].boot == stand.publisher.statuses[-1].boot
        assert stand.live.room.status(stand.now_s).episode.phase == EPISODE_PHASE_PRACTICE


def _do(work: Callable[[], None]) -> None:
    work()
