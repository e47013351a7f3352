"""What a room knows of its recorder: which episodes are saved, and whether the one that goes on is kept."""

from __future__ import annotations

import pytest

from mart.protocol.messages import OUTCOME_FAILURE, OUTCOME_SUCCESS, Event, RecordingReport
from mart.sim.room.saved_room import SavedRoom
from mart.sim.world import World
from tests.sim.room.room_harness import RoomHarness


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


@pytest.fixture
def harness(world: World) -> RoomHarness:
    return RoomHarness(world)


def test_saved_and_good_episodes_are_counted(world: World) -> None:
    harness = RoomHarness(world, SavedRoom(seed=1, episodes=3))
    said = ((1, OUTCOME_SUCCESS, True), (2, OUTCOME_SUCCESS, False), (3, OUTCOME_FAILURE, True))
    for number, outcome, verified in said * 2:
        harness.room.episode_saved(Event.EpisodeSaved(number=number, outcome=outcome, verified=verified))
    assert (harness.status().episodes_saved, harness.status().episodes_good) == (3, 1)
    assert (harness.kept[-1].saved, harness.kept[-1].good) == (3, 1)


def test_a_plan_counts_good_episodes_only(world: World) -> None:
    harness = RoomHarness(world, SavedRoom(seed=1, episodes=12, saved=9, good=4).planned(world.task.name, 2))
    assert (harness.status().plan.episodes, harness.status().plan.good) == (2, 0)
    for number, outcome in enumerate((OUTCOME_FAILURE, OUTCOME_SUCCESS), 11):
        harness.room.episode_saved(Event.EpisodeSaved(number=number, outcome=outcome, verified=True))
    assert harness.status().plan.good == 1
    assert not RoomHarness(world).status().HasField("plan")


def test_a_room_says_within_half_a_second_that_nobody_records_it(harness: RoomHarness) -> None:
    harness.record()
    harness.drive(10)
    report = RecordingReport(
        recorder="recorder-1", boot=harness.newest.boot, episode=1, last_tick=harness.newest.tick
    )
    harness.room.recording_watch.reported(report)
    assert harness.status().unrecorded == ""
    harness.drive(10)
    assert "recorder-1" in harness.status().unrecorded
    assert harness.publisher.of("notice") == []  # it may only be late
    harness.drive(40)
    report.last_tick = harness.newest.tick
    harness.room.recording_watch.reported(report)
    harness.drive(5)
    assert harness.status().unrecorded == ""
    told = [event.notice.level for event in harness.publisher.of("notice")]
    assert told[-2:] == ["error", "info"]
