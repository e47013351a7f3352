"""What a room does, seen from outside."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from mart.protocol import clock
from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STALLED,
    BARRIER_PHASE_STOPPED,
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    EpisodeRequest,
    Event,
    SeatRequest,
)
from mart.sim.room.command_validation import Rejection
from mart.sim.room.room import REPEAT_S, Room
from mart.sim.room.saved_room import RoomRecord
from mart.sim.world import World, divergence
from mart.sim.world.divergence import DivergenceArchive
from tests.sim.room.room_harness import ARMS, PERIOD_S, Heard, Stage

TASK = "two_arm_multi_cube_lifting"


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


@pytest.fixture
def stage(world: World) -> Stage:
    return Stage(world)


def test_a_room_begins_with_the_state_of_a_fresh_world(stage: Stage) -> None:
    (state,) = stage.voice.states
    assert (state.room, state.tick, state.episode, state.episode_tick) == ("room-1", 1, 0, 0)
    assert [arm.arm for arm in state.arms] == list(ARMS)
    assert all(not arm.action and not arm.fresh for arm in state.arms)
    assert state.integration_state == stage.world.integration_state()
    assert len(stage.voice.of("world_reset")) == 1


def test_nobody_there_and_the_world_lives_on(stage: Stage) -> None:
    stage.pass_time(1.0)
    assert len(stage.voice.states) == pytest.approx(1 + 20, abs=2)
    assert all(not arm.fresh and len(arm.action) == 7 for arm in stage.newest.arms)
    assert stage.newest.straggler == ""


def test_a_tick_waits_for_every_command(stage: Stage) -> None:
    for arm in ARMS:
        stage.take(arm)
    before = len(stage.voice.states)
    stage.command("arm0")
    stage.pass_time(0.2)
    assert len(stage.voice.states) == before
    stage.command("arm1")
    stage.pass_time(0.01)
    assert len(stage.voice.states) == before + 1


def test_a_state_tells_what_moved_each_arm(stage: Stage) -> None:
    stage.take("arm1")
    stage.pass_time(0.04)
    stage.command("arm1", x_m=0.02, gripper=1.0)
    stage.pass_time(PERIOD_S)
    held, driven = stage.newest.arms
    assert (held.fresh, held.sequence, held.source, held.seat_epoch) == (False, 0, OPERATOR_HOLD, 1)
    assert (driven.fresh, driven.sequence, driven.source, driven.seat_epoch) == (True, 1, OPERATOR_HUMAN, 2)
    assert driven.action[0] == pytest.approx(0.4)  # 2 cm of the 5 cm that a tick allows
    assert driven.action[6] == 1.0
    assert driven.engaged
    assert driven.arrived_ns > 0
    assert stage.newest.straggler == "arm1"


def test_states_replay_to_the_same_bytes(stage: Stage, world: World) -> None:
    stage.record()
    stage.drive(20, x_m=0.03)
    states = [state for state in stage.voice.states if state.episode]
    assert [state.episode_tick for state in states] == list(range(len(states)))
    assert [state.tick for state in states] == list(range(states[0].tick, states[0].tick + len(states)))
    world.set_integration_state(states[0].integration_state)
    for state in states[1:]:
        world.step([list(arm.action) for arm in state.arms])
        assert world.integration_state() == state.integration_state


def test_a_held_arm_stays_where_it_was_left(stage: Stage) -> None:
    stage.take("arm0")
    for _ in range(20):
        stage.command("arm0", x_m=0.04)
        stage.pass_time(PERIOD_S)
    stage.room.answer_seat(
        SeatRequest(release=SeatRequest.Release(arm="arm0", holder_id="arm0")), stage.now_s
    )
    stage.pass_time(1.0)
    left = stage.world.tool_pose_in_base("arm0")
    stage.pass_time(20.0)
    metres, radians = stage.world.tool_pose_in_base("arm0").distance_to(left)
    assert metres < 1e-4
    assert radians < 1e-3


def test_a_held_arm_keeps_its_gripper_closed(stage: Stage) -> None:
    stage.take("arm0")
    for _ in range(10):
        stage.command("arm0", gripper=1.0)
        stage.pass_time(PERIOD_S)
    stage.room.answer_seat(
        SeatRequest(release=SeatRequest.Release(arm="arm0", holder_id="arm0")), stage.now_s
    )
    stage.pass_time(0.5)
    assert stage.newest.arms[0].action[6] == 1.0


def test_silence_stalls_pauses_and_frees_the_seat(stage: Stage) -> None:
    stage.take("arm0")
    stage.take("arm1")
    for silence_s, phase in (
        (0.2, BARRIER_PHASE_RUNNING),
        (0.5, BARRIER_PHASE_STALLED),
        (4.0, BARRIER_PHASE_PAUSED),
        (29.0, BARRIER_PHASE_PAUSED),
    ):
        while stage.now_s < 1000.0 + silence_s:
            stage.command("arm1")
            stage.pass_time(0.1)
        assert stage.status().barrier == phase
    assert [waiting.arm for waiting in stage.status().waiting_for] == ["arm0"]
    while stage.now_s < 1031.0:
        stage.command("arm1")
        stage.pass_time(0.1)
    assert [seat.operator for seat in stage.status().seats] == [OPERATOR_HOLD, OPERATOR_HUMAN]
    assert stage.status().barrier == BARRIER_PHASE_RUNNING
    changes = [event.barrier_changed.phase for event in stage.voice.of("barrier_changed")]
    assert changes == [BARRIER_PHASE_STALLED, BARRIER_PHASE_PAUSED, BARRIER_PHASE_RUNNING]
    assert [event.notice.level for event in stage.voice.of("notice")] == ["warning"]


def test_latecomers_hear_the_newest_state_again_while_nothing_ticks(stage: Stage) -> None:
    stage.take("arm0")
    stage.pass_time(1.0)
    assert stage.voice.repeats == pytest.approx(1.0 / REPEAT_S, abs=1)


def test_status_comes_five_times_a_second(stage: Stage) -> None:
    stage.pass_time(2.0)
    assert len(stage.voice.statuses) == pytest.approx(2.0 / REPEAT_S, abs=2)


def test_a_seat_that_is_taken_stays_taken(stage: Stage) -> None:
    stage.take("arm0", "ana")
    claim = SeatRequest.Claim(arm="arm0", holder_id="ben", name="Ben", operator=OPERATOR_HUMAN)
    reply = stage.room.answer_seat(SeatRequest(claim=claim), stage.now_s)
    assert reply.error.code == "Conflict"
    assert stage.status().seats[0].holder_id == "ana"


def test_an_emergency_stop_stops_the_world_and_marks_the_episode(stage: Stage) -> None:
    stage.record()
    stage.command("arm0", stop=True)
    stage.command("arm1")
    before = len(stage.voice.states)
    stage.pass_time(0.2)
    assert len(stage.voice.states) == before
    assert stage.status().barrier == BARRIER_PHASE_STOPPED
    assert stage.status().episode.interrupted
    stage.drive(3)
    assert stage.status().barrier == BARRIER_PHASE_RUNNING


def test_an_episode_from_ready_to_practice(stage: Stage) -> None:
    for arm in ARMS:
        stage.take(arm)
    stage.drive(3)
    stage.ready()
    assert stage.status().episode.phase == EPISODE_PHASE_COUNTDOWN
    ticks = len(stage.voice.states)
    for _ in range(29):
        stage.drive(2)
    assert len(stage.voice.states) == ticks  # the countdown's world stands still
    stage.drive(10)
    assert stage.status().episode.phase == EPISODE_PHASE_RECORDING
    (started,) = stage.voice.of("episode_started")
    assert started.episode_started.seed == stage.status().episode.seed
    finish = EpisodeRequest.Finish(holder_id="arm1", outcome=OUTCOME_SUCCESS)
    assert stage.ask(EpisodeRequest(finish=finish)) == ""
    (ended,) = stage.voice.of("episode_ended")
    assert ended.episode_ended.last_tick == stage.newest.tick
    assert ended.episode_ended.ticks == stage.newest.episode_tick
    assert stage.status().episode.phase == EPISODE_PHASE_ENDED
    stage.drive(42)
    assert stage.status().episode.phase == EPISODE_PHASE_PRACTICE
    assert stage.newest.episode == 0
    assert stage.kept[-1].episodes == 1


def test_a_recording_begins_with_the_world_of_its_seed(stage: Stage, world: World) -> None:
    stage.record()
    first = next(state for state in stage.voice.states if state.episode)
    seed = stage.voice.of("episode_started")[0].episode_started.seed
    world.reset(seed)
    assert first.integration_state == world.integration_state()


def test_a_pause_interrupts_the_episode(stage: Stage) -> None:
    stage.record()
    stage.pass_time(3.5)
    assert stage.status().episode.interrupted


def test_a_world_that_diverges_ends_the_episode_and_is_reset(world: World, tmp_path: Path) -> None:
    stage = Stage(world, explain=DivergenceArchive(tmp_path / "diverged", "room-1", clock.wall_ns).keep)
    stage.record()
    stage.drive(2)
    world.data.qvel[:] = 1e9  # truly out of bounds after a substep or two
    stage.drive(1)
    (ended,) = stage.voice.of("episode_ended")
    assert (ended.episode_ended.outcome, ended.episode_ended.reason) == (
        OUTCOME_FAILURE,
        "the physics diverged",
    )
    assert stage.status().episode.phase == EPISODE_PHASE_PRACTICE
    stage.drive(2)
    assert stage.newest.arms[0].fresh
    (path,) = (tmp_path / "diverged").iterdir()
    assert str(path) in stage.voice.of("notice")[-1].notice.text
    last, told = divergence.load(path), {state.tick: state for state in stage.voice.states}
    good = told[ended.episode_ended.last_tick - 1]
    assert last.states[-2].tobytes() == good.integration_state


def test_what_a_room_keeps_lets_it_go_on(stage: Stage, world: World) -> None:
    stage.record()
    again = Stage(world, stage.kept[-1])
    assert [(seat.operator, seat.epoch) for seat in again.status().seats] == [(OPERATOR_HUMAN, 2)] * 2
    assert again.status().episode.number == 1
    assert again.status().boot != stage.status().boot
    again.drive(2)
    assert all(arm.fresh for arm in again.newest.arms)


def test_saved_and_good_episodes_are_counted(stage: Stage) -> None:
    for outcome, verified in ((OUTCOME_SUCCESS, True), (OUTCOME_SUCCESS, False), (OUTCOME_FAILURE, True)):
        stage.room.episode_saved(Event.EpisodeSaved(number=1, outcome=outcome, verified=verified))
    assert (stage.status().episodes_saved, stage.status().episodes_good) == (3, 1)
    assert (stage.kept[-1].saved, stage.kept[-1].good) == (3, 1)


def test_a_plan_counts_good_episodes_only(world: World) -> None:
    stage = Stage(world, RoomRecord(seed=1, saved=9, good=4).planned(world.task.name, 2))
    assert (stage.status().plan.episodes, stage.status().plan.good) == (2, 0)
    for outcome in (OUTCOME_FAILURE, OUTCOME_SUCCESS):
        stage.room.episode_saved(Event.EpisodeSaved(number=1, outcome=outcome, verified=True))
    assert stage.status().plan.good == 1
    assert not Stage(world).status().HasField("plan")


def test_a_full_disk_does_not_stop_the_world(world: World) -> None:
    def keep(_record: RoomRecord) -> None:
        raise OSError(28, "No space left on device")

    voice = Heard()
    room = Room("room-1", world, RoomRecord(seed=1), voice, keep, now_s=0.0)
    room.advance(0.0)
    assert len(voice.states) == 2
    assert "No space left" in voice.of("notice")[0].notice.text


def test_garbage_is_counted_and_changes_nothing(stage: Stage) -> None:
    stage.take("arm0")
    stage.command("arm0", x_m=math.nan)
    stage.room.hear(b"\xff\xff", "arm0", stage.now_s, 0)
    stage.room.hear(b"", "arm0", stage.now_s, 0)
    stage.pass_time(0.06)
    assert stage.status().rejected_commands == 3
    assert stage.room.rejected[Rejection.NOT_FINITE] == 1
    assert not any(state.arms[0].fresh for state in stage.voice.states)
