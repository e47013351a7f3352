"""An emergency stop latches, whatever becomes of who pressed it; commands have an age."""

from __future__ import annotations

import pytest

from mart.protocol.messages import BARRIER_PHASE_RUNNING, BARRIER_PHASE_STOPPED, OPERATOR_HOLD, EpisodeRequest
from mart.sim.room.command_validation import CommandRejection
from mart.sim.world import World
from tests.sim.room.room_harness import ARMS, RoomHarness


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


@pytest.fixture
def harness(world: World) -> RoomHarness:
    return RoomHarness(world)


def stop_request(name: str = "Ben", holder_id: str = "") -> EpisodeRequest:
    return EpisodeRequest(stop=EpisodeRequest.Stop(name=name, holder_id=holder_id))


def go_on_request(name: str = "Eva") -> EpisodeRequest:
    return EpisodeRequest(go_on=EpisodeRequest.GoOn(name=name))


def test_an_emergency_stop_stops_the_world_until_a_person_lets_go_and_marks_the_episode(
    harness: RoomHarness,
) -> None:
    harness.record()
    harness.command("arm0", stop=True)
    harness.command("arm1")
    before = len(harness.publisher.states)
    harness.pass_time(0.2)
    assert len(harness.publisher.states) == before
    assert harness.status().barrier == BARRIER_PHASE_STOPPED
    assert (harness.status().stop.arm, harness.status().stop.name) == ("arm0", "Ana")
    assert harness.status().episode.interrupted
    harness.drive(3)  # the button is up again
    assert harness.status().barrier == BARRIER_PHASE_STOPPED
    assert len(harness.publisher.states) == before
    assert harness.ask(go_on_request()) == ""
    harness.drive(3)
    assert harness.status().barrier == BARRIER_PHASE_RUNNING
    assert not harness.status().HasField("stop")
    texts = [event.notice.text for event in harness.publisher.of("notice")]
    assert [text for text in texts if "everything" in text] == [
        "Ana stopped everything.",
        "Eva let go of the emergency stop: everything goes on.",
    ]


def test_an_emergency_stop_outlives_whoever_pressed_it_and_the_sim(world: World) -> None:
    harness = RoomHarness(world)
    harness.take("arm0")
    harness.command("arm0", stop=True)
    harness.pass_time(31.0)  # the page is gone, and its seat is given up
    assert harness.status().seats[0].operator == OPERATOR_HOLD
    assert harness.status().barrier == BARRIER_PHASE_STOPPED
    restarted = RoomHarness(world, record=harness.kept[-1])
    restarted.pass_time(1.0)
    assert restarted.status().barrier == BARRIER_PHASE_STOPPED
    assert restarted.status().stop.name == "Ana"
    assert restarted.ask(go_on_request()) == ""
    assert restarted.kept[-1].stop is None


def test_anybody_stops_everything_and_the_first_is_named(harness: RoomHarness) -> None:
    harness.take("arm1", "ana")
    assert harness.ask(go_on_request()) == "Conflict"
    assert harness.ask(stop_request("")) == "InvalidInput"
    assert harness.ask(stop_request("Ben")) == ""
    assert harness.ask(stop_request("Ana", "ana")) == ""
    assert (harness.status().stop.arm, harness.status().stop.name) == ("", "Ben")
    assert harness.ask(go_on_request()) == ""
    assert harness.ask(stop_request("Ana", "ana")) == ""
    assert harness.status().stop.arm == "arm1"


def test_commands_that_were_made_from_an_old_state_are_refused_counted_and_told(harness: RoomHarness) -> None:
    for arm in ARMS:
        harness.take(arm)
    harness.drive(30)
    tick = harness.newest.tick
    for made_from, accepted in ((tick, True), (tick - 20, True), (tick - 21, False), (tick + 1, False)):
        before = harness.room.rejected[CommandRejection.OLD_STATE]
        harness.command("arm0", state_tick=made_from)
        assert (harness.room.rejected[CommandRejection.OLD_STATE] == before) == accepted
    for _ in range(10):
        harness.command("arm0", state_tick=tick - 25)
    (told,) = harness.publisher.of("notice")
    assert "Ana at arm0 does not hear the room" in told.notice.text


def test_a_command_that_waited_moves_nothing_and_stops_everything_all_the_same(harness: RoomHarness) -> None:
    """A link to another site was broken for 3 s: the world stood still, so the state is as old as it was."""
    for arm in ARMS:
        harness.take(arm)
    for _ in range(30):
        for arm in ARMS:
            harness.command(arm, sent_s=harness.now_s - 0.15)
        harness.pass_time(0.05)
    harness.pass_time(3.0)
    stood = harness.newest.tick
    for late_s in (3.0, 2.0, 1.0, 0.7):
        for arm in ARMS:
            harness.command(arm, x_m=0.1, sent_s=harness.now_s - 0.15 - late_s)
        harness.pass_time(0.05)
    assert harness.newest.tick == stood
    assert harness.room.rejected[CommandRejection.WAITED] == 4 * len(ARMS)
    for arm in ARMS:
        harness.command(arm, sent_s=harness.now_s - 0.15)
    harness.pass_time(0.05)
    assert harness.newest.tick > stood
    harness.command("arm0", stop=True, sent_s=harness.now_s - 2.0)
    assert harness.room.rejected[CommandRejection.WAITED] == 4 * len(ARMS) + 1
    assert harness.status().stop.arm == "arm0"


def test_a_reset_voids_what_was_made_from_the_world_before_it(harness: RoomHarness) -> None:
    for arm in ARMS:
        harness.take(arm)
    harness.drive(3)
    before = harness.newest.tick
    assert harness.ask(EpisodeRequest(reset=EpisodeRequest.Reset(holder_id="arm0"))) == ""
    harness.command("arm0", state_tick=before)
    assert harness.room.rejected[CommandRejection.OLD_STATE] == 1
    harness.command("arm0", state_tick=before + 1)
    assert harness.room.rejected[CommandRejection.OLD_STATE] == 1
    assert not harness.publisher.of("notice")
