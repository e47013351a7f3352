"""What a room does, seen from outside."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from mart.protocol import clock
from mart.protocol.holders import is_held_by
from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STALLED,
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    EpisodeRequest,
    SeatRequest,
)
from mart.sim.room.command_validation import CommandRejection
from mart.sim.room.room import Room
from mart.sim.room.room_publisher import REPEAT_S, STATUS_S
from mart.sim.room.saved_room import SavedRoom
from mart.sim.world import World, divergence
from mart.sim.world.divergence import DivergenceArchive
from tests.sim.room.room_harness import ARMS, PERIOD_S, CapturingPublisher, RoomHarness

TASK = "two_arm_multi_cube_lifting"


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


@pytest.fixture
def harness(world: World) -> RoomHarness:
    return RoomHarness(world)


def test_a_room_begins_with_the_state_of_a_fresh_world(harness: RoomHarness) -> None:
    (state,) = harness.publisher.states
    assert (state.room, state.tick, state.episode, state.episode_tick) == ("room-1", 1, 0, 0)
    assert [arm.arm for arm in state.arms] == list(ARMS)
    assert all(not arm.action and not arm.fresh for arm in state.arms)
    assert state.integration_state == harness.world.integration_state()
    assert len(harness.publisher.of("world_reset")) == 1


def test_nobody_there_and_the_world_lives_on(harness: RoomHarness) -> None:
    harness.pass_time(1.0)
    assert len(harness.publisher.states) == pytest.approx(1 + 20, abs=2)
    assert all(not arm.fresh and len(arm.action) == 7 for arm in harness.newest.arms)
    assert harness.newest.straggler == ""


def test_a_tick_waits_for_every_command(harness: RoomHarness) -> None:
    for arm in ARMS:
        harness.take(arm)
    before = len(harness.publisher.states)
    harness.command("arm0")
    harness.pass_time(0.2)
    assert len(harness.publisher.states) == before
    harness.command("arm1")
    harness.pass_time(0.01)
    assert len(harness.publisher.states) == before + 1


def test_a_state_tells_what_moved_each_arm(harness: RoomHarness) -> None:
    harness.take("arm1")
    harness.pass_time(0.04)
    harness.command("arm1", x_m=0.02, gripper=1.0)
    harness.pass_time(PERIOD_S)
    held, driven = harness.newest.arms
    assert (held.fresh, held.sequence, held.source, held.seat_epoch) == (False, 0, OPERATOR_HOLD, 1)
    assert (driven.fresh, driven.sequence, driven.source, driven.seat_epoch) == (True, 1, OPERATOR_HUMAN, 2)
    assert driven.action[0] == pytest.approx(0.4)  # 2 cm of the 5 cm that a tick allows
    assert driven.action[6] == 1.0
    assert driven.engaged
    assert driven.arrived_ns > 0
    assert harness.newest.straggler == "arm1"


def test_states_replay_to_the_same_bytes(harness: RoomHarness, world: World) -> None:
    harness.record()
    harness.drive(20, x_m=0.03)
    states = [state for state in harness.publisher.states if state.episode]
    assert [state.episode_tick for state in states] == list(range(len(states)))
    assert [state.tick for state in states] == list(range(states[0].tick, states[0].tick + len(states)))
    world.set_integration_state(states[0].integration_state)
    for state in states[1:]:
        world.step([list(arm.action) for arm in state.arms])
        assert world.integration_state() == state.integration_state


def test_a_held_arm_stays_where_it_was_left(harness: RoomHarness) -> None:
    harness.take("arm0")
    for _ in range(20):
        harness.command("arm0", x_m=0.04)
        harness.pass_time(PERIOD_S)
    harness.room.answer_seat(
        SeatRequest(release=SeatRequest.Release(arm="arm0", holder_id="arm0")), harness.now_s
    )
    harness.pass_time(1.0)
    left = harness.world.tool_pose_in_base("arm0")
    harness.pass_time(20.0)
    metres, radians = harness.world.tool_pose_in_base("arm0").distance_to(left)
    assert metres < 1e-4
    assert radians < 1e-3


def test_a_held_arm_keeps_its_gripper_closed(harness: RoomHarness) -> None:
    harness.take("arm0")
    for _ in range(10):
        harness.command("arm0", gripper=1.0)
        harness.pass_time(PERIOD_S)
    harness.room.answer_seat(
        SeatRequest(release=SeatRequest.Release(arm="arm0", holder_id="arm0")), harness.now_s
    )
    harness.pass_time(0.5)
    assert harness.newest.arms[0].action[6] == 1.0


def test_silence_stalls_pauses_and_frees_the_seat(harness: RoomHarness) -> None:
    harness.take("arm0")
    harness.take("arm1")
    for silence_s, phase in (
        (0.2, BARRIER_PHASE_RUNNING),
        (0.5, BARRIER_PHASE_STALLED),
        (4.0, BARRIER_PHASE_PAUSED),
        (29.0, BARRIER_PHASE_PAUSED),
    ):
        while harness.now_s < 1000.0 + silence_s:
            harness.command("arm1")
            harness.pass_time(0.1)
        assert harness.status().barrier == phase
    assert [waiting.arm for waiting in harness.status().waiting_for] == ["arm0"]
    while harness.now_s < 1031.0:
        harness.command("arm1")
        harness.pass_time(0.1)
    assert [seat.operator for seat in harness.status().seats] == [OPERATOR_HOLD, OPERATOR_HUMAN]
    assert harness.status().barrier == BARRIER_PHASE_RUNNING
    changes = [event.barrier_changed.phase for event in harness.publisher.of("barrier_changed")]
    assert changes == [BARRIER_PHASE_STALLED, BARRIER_PHASE_PAUSED, BARRIER_PHASE_RUNNING]
    assert [event.notice.level for event in harness.publisher.of("notice")] == ["warning"]


def test_latecomers_hear_the_newest_state_again_while_nothing_ticks(harness: RoomHarness) -> None:
    harness.take("arm0")
    harness.pass_time(1.0)
    assert harness.publisher.repeats == pytest.approx(1.0 / REPEAT_S, abs=1)


def test_waiting_for_a_newcomer_or_after_a_pause_is_not_slowness(harness: RoomHarness) -> None:
    harness.pass_time(5.0)
    for silence_s in (1.5, 4.0):
        harness.take("arm0")
        harness.pass_time(silence_s)  # the page connects
        assert harness.status().real_time_factor < 0.9
        for _ in range(12):
            harness.command("arm0")
            harness.pass_time(PERIOD_S / 4)
            assert harness.status().real_time_factor == pytest.approx(1.0)


def test_status_comes_ten_times_a_second(harness: RoomHarness) -> None:
    harness.pass_time(2.0)
    assert len(harness.publisher.statuses) == pytest.approx(2.0 / STATUS_S, abs=2)


def test_a_seat_that_is_taken_stays_taken(harness: RoomHarness) -> None:
    harness.take("arm0", "ana")
    claim = SeatRequest.Claim(arm="arm0", holder_id="ben", name="Ben", operator=OPERATOR_HUMAN)
    reply = harness.room.answer_seat(SeatRequest(claim=claim), harness.now_s)
    assert reply.error.code == "Conflict"
    assert is_held_by(harness.status().seats[0], "ana")


def test_an_episode_from_ready_to_practice(harness: RoomHarness) -> None:
    for arm in ARMS:
        harness.take(arm)
    harness.drive(3)
    harness.ready()
    assert harness.status().episode.phase == EPISODE_PHASE_COUNTDOWN
    ticks = len(harness.publisher.states)
    for _ in range(29):
        harness.drive(2)
    assert len(harness.publisher.states) == ticks  # the countdown's world stands still
    harness.drive(10)
    assert harness.status().episode.phase == EPISODE_PHASE_RECORDING
    (started,) = harness.publisher.of("episode_started")
    assert started.episode_started.seed == harness.status().episode.seed
    finish = EpisodeRequest.Finish(holder_id="arm1", outcome=OUTCOME_SUCCESS)
    assert harness.ask(EpisodeRequest(finish=finish)) == ""
    (ended,) = harness.publisher.of("episode_ended")
    assert ended.episode_ended.last_tick == harness.newest.tick
    assert ended.episode_ended.ticks == harness.newest.episode_tick
    assert harness.status().episode.phase == EPISODE_PHASE_ENDED
    harness.drive(42)
    assert harness.status().episode.phase == EPISODE_PHASE_PRACTICE
    assert harness.newest.episode == 0
    assert harness.kept[-1].episodes == 1


def test_a_recording_begins_with_the_world_of_its_seed(harness: RoomHarness, world: World) -> None:
    harness.record()
    first = next(state for state in harness.publisher.states if state.episode)
    seed = harness.publisher.of("episode_started")[0].episode_started.seed
    world.reset(seed)
    assert first.integration_state == world.integration_state()


def test_a_pause_interrupts_the_episode(harness: RoomHarness) -> None:
    harness.record()
    harness.pass_time(3.5)
    assert harness.status().episode.interrupted


def test_a_world_that_diverges_ends_the_episode_and_is_reset(world: World, tmp_path: Path) -> None:
    harness = RoomHarness(
        world, explain=DivergenceArchive(tmp_path / "diverged", "room-1", clock.wall_ns).keep
    )
    harness.record()
    harness.drive(2)
    world.data.qvel[:] = 1e9  # truly out of bounds after a substep or two
    harness.drive(1)
    (ended,) = harness.publisher.of("episode_ended")
    assert (ended.episode_ended.outcome, ended.episode_ended.reason) == (
        OUTCOME_FAILURE,
        "the physics diverged",
    )
    assert harness.status().episode.phase == EPISODE_PHASE_PRACTICE
    harness.drive(2)
    assert harness.newest.arms[0].fresh
    (path,) = (tmp_path / "diverged").iterdir()
    assert str(path) in harness.publisher.of("notice")[-1].notice.text
    last, told = divergence.load(path), {state.tick: state for state in harness.publisher.states}
    good = told[ended.episode_ended.last_tick - 1]
    assert last.states[-2].tobytes() == good.integration_state


def test_what_a_room_keeps_lets_it_go_on(harness: RoomHarness, world: World) -> None:
    harness.record()
    again = RoomHarness(world, harness.kept[-1])
    assert [(seat.operator, seat.epoch) for seat in again.status().seats] == [(OPERATOR_HUMAN, 2)] * 2
    assert again.status().episode.number == 1
    assert again.status().boot != harness.status().boot
    again.drive(2)
    assert all(arm.fresh for arm in again.newest.arms)


def test_a_full_disk_does_not_stop_the_world(world: World) -> None:
    def keep(_record: SavedRoom) -> None:
        raise OSError(28, "No space left on device")

    publisher = CapturingPublisher()
    room = Room("room-1", world, SavedRoom(seed=1), publisher, keep, now_s=0.0)
    room.advance(0.0)
    assert len(publisher.states) == 2
    assert "No space left" in publisher.of("notice")[0].notice.text


def test_garbage_is_counted_and_changes_nothing(harness: RoomHarness) -> None:
    harness.take("arm0")
    harness.command("arm0", x_m=math.nan)
    harness.room.hear(b"\xff\xff", "arm0", harness.now_s, 0)
    harness.room.hear(b"", "arm0", harness.now_s, 0)
    harness.pass_time(0.06)
    assert harness.status().rejected_commands == 3
    assert harness.room.rejected[CommandRejection.NOT_FINITE] == 1
    assert not any(state.arms[0].fresh for state in harness.publisher.states)
