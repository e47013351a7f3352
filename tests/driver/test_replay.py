"""A recorded way is sent to two real arms through their room: slower, and no further once anything stops it."""

from __future__ import annotations

import numpy as np
import pytest

from mart.episodes.arrays import EpisodeData, arrays_for_task
from mart.operators.commander import SeatCommander
from mart.protocol import codec
from mart.protocol.errors import Conflict
from mart.protocol.messages import OPERATOR_POLICY, EpisodeRequest, SeatRequest
from mart.recorder.replay.ends import EndWatch
from mart.recorder.replay.led_way import RecordedWay
from mart.recorder.replay.way_operator import WayOperator
from mart.sim.world import World
from tests.driver.rehearsal import LIMITS, Rehearsal
from tests.sim.room.room_harness import ARMS, PERIOD_S

SPEED = 0.5
_HOLDER = "replay"
_STANDS_RAD = 0.002


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


@pytest.fixture(scope="module")
def recording(world: World) -> EpisodeData:
    """Two people swing real arms for a moment."""
    rehearsal = Rehearsal(world)
    for arm in ARMS:
        rehearsal.take(arm)
    rehearsal.ask(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva")))
    rehearsal.press()
    rehearsal.pass_time(0.5)
    begun = len(rehearsal.publisher.states)
    rehearsal.pass_time(2.0)
    states = rehearsal.publisher.states[begun:]
    for number, state in enumerate(states):
        state.episode_tick = number
    return arrays_for_task(states, world.task)


class Replaying(Rehearsal):
    """The replay holds both seats of a room with two real arms, which stand where arms stand at first."""

    def __init__(self, world: World, data: EpisodeData) -> None:
        self.done = False
        self.observed = 0
        self.watch = EndWatch(ARMS, _HOLDER)
        self.commander: SeatCommander | None = None
        super().__init__(world)
        self.operator = WayOperator(RecordedWay.of(data, ARMS), SPEED, 1 / PERIOD_S, self._finish)

    def begin(self) -> None:
        """Take both seats, once a person lets the room go on."""
        assert self.ask(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva"))) == ""
        for arm in ARMS:
            claim = SeatRequest.Claim(arm=arm, holder_id=_HOLDER, name="replay", operator=OPERATOR_POLICY)
            assert not self.room.answer_seat(SeatRequest(claim=claim), self.now_s).error.code
        self.observed = len(self.publisher.statuses)
        self.commander = SeatCommander(self.operator, self.world.task, ARMS, OPERATOR_POLICY)
        self.commander.seat({seat.arm: seat.epoch for seat in self.status().seats})

    def _finish(self) -> None:
        self.done = True

    def _speak(self) -> None:
        """Say what the replay says, in place of the people: on new states, and again and again."""
        if self.commander is None:
            return
        for status in self.publisher.statuses[self.observed :]:
            self.watch.hear(status)
        self.observed = len(self.publisher.statuses)
        if self.watch.why or self.done:
            return
        self.commander.observe(self.newest)
        for command in self.commander.commands(0):
            self.room.hear(codec.encode(command), command.arm, self.now_s, round(self.now_s * 1e9))

    def fastest_rad_s(self, begun_s: float) -> float:
        rows = [[one.joints for one in arm.history if one.at_s >= begun_s] for arm in self.hardware.values()]
        return max(float(np.abs(np.diff(np.array(row), axis=0)).max() / 0.002) for row in rows)


@pytest.mark.slow
def test_both_arms_go_the_recorded_way_in_twice_the_time(world: World, recording: EpisodeData) -> None:
    replaying = Replaying(world, recording)
    replaying.begin()
    begun_s = replaying.now_s
    while not replaying.done and replaying.now_s < begun_s + 30.0:
        replaying.pass_time(0.5)
    assert replaying.watch.why == ""
    assert replaying.done
    for index, arm in enumerate(ARMS):
        tool = replaying.world.tool_pose_in_base(arm)
        assert tool.position == pytest.approx(recording.tool_positions_in_base[-1, index], abs=0.025)
    assert replaying.now_s - begun_s > recording.sim_time_s[-1] / SPEED
    assert replaying.fastest_rad_s(begun_s) < LIMITS.joint_speed_rad_s


@pytest.mark.parametrize("what", ["a person", "a driver"])
def test_a_stop_ends_it_and_nothing_moves_when_the_stop_is_let_go(
    world: World, recording: EpisodeData, what: str
) -> None:
    replaying = Replaying(world, recording)
    replaying.begin()
    replaying.pass_time(2.0)
    assert replaying.operator.time_s > 0.5
    begun_s = replaying.now_s
    if what == "a person":
        replaying.ask(EpisodeRequest(stop=EpisodeRequest.Stop(name="Ben")))
    else:
        replaying.drivers["arm1"].killed = True
    replaying.pass_time(1.2)
    assert replaying.stood_after_s(begun_s) < 0.3
    assert replaying.watch.why.startswith("Ben" if what == "a person" else "Driver of arm1 (SimulatedArm)")
    if what == "a driver":
        replaying.start_driver("arm1")
        replaying.pass_time(0.3)
    stood_s = replaying.now_s
    assert replaying.ask(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva"))) == ""
    replaying.pass_time(2.0)
    assert replaying.most_moved_rad(stood_s) < _STANDS_RAD


def test_an_arm_that_stands_elsewhere_is_not_moved(world: World, recording: EpisodeData) -> None:
    replaying = Replaying(world, recording)
    for joints in (replaying.hardware["arm1"].joints, replaying.hardware["arm1"]._goal):
        joints[3] += 1.2
    replaying.pass_time(0.3)
    replaying.begin()
    begun_s = replaying.now_s
    with pytest.raises(Conflict, match="arm1 stands too far"):
        replaying.pass_time(1.0)
    assert replaying.most_moved_rad(begun_s) < _STANDS_RAD
