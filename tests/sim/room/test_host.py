"""What a host does in a room: it counts for everybody, and only a host takes it back."""

from __future__ import annotations

import pytest

from mart.protocol.messages import (
    BARRIER_PHASE_STOPPED,
    ENDED_BY_OPERATOR,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OUTCOME_SUCCESS,
    EpisodeRequest,
    SeatRequest,
)
from mart.sim.room.saved_room import SavedRoom
from mart.sim.world import World
from tests.sim.room.room_harness import RoomHarness


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


@pytest.fixture
def harness(world: World) -> RoomHarness:
    return RoomHarness(world)


def notices(harness: RoomHarness) -> list[str]:
    return [event.notice.text for event in harness.publisher.of("notice")]


def stop(name: str, *, by_host: bool = False) -> EpisodeRequest:
    return EpisodeRequest(stop=EpisodeRequest.Stop(name=name, by_host=by_host))


def go_on(name: str, *, by_host: bool = False) -> EpisodeRequest:
    return EpisodeRequest(go_on=EpisodeRequest.GoOn(name=name, by_host=by_host))


def planned(episodes: int) -> EpisodeRequest:
    return EpisodeRequest(set_plan=EpisodeRequest.SetPlan(episodes=episodes, name="Hanna"))


def test_a_host_frees_a_seat_and_whoever_sat_there_is_told(harness: RoomHarness) -> None:
    harness.take("arm0")
    before = harness.status().seats[0]
    free = SeatRequest(free=SeatRequest.Free(arm="arm0", name="Hanna"))
    reply = harness.room.answer_seat(free, harness.now_s)
    assert (before.operator, reply.seat.operator) == (OPERATOR_HUMAN, OPERATOR_HOLD)
    assert reply.seat.epoch == before.epoch + 1
    assert notices(harness) == ["Hanna, the host, freed arm0."]
    assert harness.room.answer_seat(free, harness.now_s).seat.epoch == reply.seat.epoch  # it is free already
    for bad, code in (("arm9", "NotFound"), ("arm0", "InvalidInput")):
        request = SeatRequest(free=SeatRequest.Free(arm=bad, name="" if code == "InvalidInput" else "Hanna"))
        assert harness.room.answer_seat(request, harness.now_s).error.code == code
    assert len(notices(harness)) == 1


def test_a_host_ends_an_episode_for_all_and_is_named(harness: RoomHarness) -> None:
    harness.record()
    stranger = EpisodeRequest.Finish(holder_id="", outcome=OUTCOME_SUCCESS)
    assert harness.ask(EpisodeRequest(finish=stranger)) == "Forbidden"
    nameless = EpisodeRequest.Finish(host="a\nb", outcome=OUTCOME_SUCCESS)
    assert harness.ask(EpisodeRequest(finish=nameless)) == "InvalidInput"
    host = EpisodeRequest.Finish(host="Hanna", outcome=OUTCOME_SUCCESS)
    assert harness.ask(EpisodeRequest(finish=host)) == ""
    ended = harness.status().last_ended
    assert (ended.outcome, ended.ended_by, ended.ended_by_name) == (
        OUTCOME_SUCCESS,
        ENDED_BY_OPERATOR,
        "Hanna",
    )
    assert (ended.reason, ended.ended_by_arm) == ("said by Hanna, the host", "")
    assert harness.ask(EpisodeRequest(finish=host)) == "Conflict"


def test_what_a_host_pauses_a_host_lets_go_on(world: World, harness: RoomHarness) -> None:
    assert harness.ask(stop("Ana")) == ""
    assert harness.ask(stop("Hanna", by_host=True)) == ""
    assert harness.ask(stop("Ana")) == ""
    assert (harness.status().stop.name, harness.status().stop.by_host) == ("Hanna", True)
    assert harness.ask(go_on("Ana")) == "Forbidden"
    restarted = RoomHarness(world, record=harness.kept[-1])
    restarted.pass_time(0.5)
    assert restarted.status().barrier == BARRIER_PHASE_STOPPED
    assert restarted.ask(go_on("Ana")) == "Forbidden"
    assert restarted.ask(go_on("Hanna", by_host=True)) == ""
    assert (restarted.status().stop.name, restarted.status().stop.by_host) == ("Ana", False)
    assert restarted.ask(go_on("Ana")) == ""
    assert not restarted.status().HasField("stop")
    assert notices(restarted) == [
        "Hanna ended the pause: Ana had stopped everything, which holds.",
        "Ana let go of the emergency stop: everything goes on.",
    ]
    assert notices(harness) == ["Ana stopped everything.", "Hanna paused the room."]


@pytest.mark.parametrize("by_hand", [True, False])
def test_a_stop_that_is_pressed_during_a_pause_outlives_it(harness: RoomHarness, *, by_hand: bool) -> None:
    harness.take("arm0")
    harness.command("arm0")
    assert harness.ask(stop("Hanna", by_host=True)) == ""
    for _ in range(2):  # a press is in every command for a second
        if by_hand:
            harness.command("arm0", stop=True)
        else:
            assert harness.ask(stop("Ana")) == ""
    assert (harness.status().stop.name, harness.status().stop.also_name) == ("Hanna", "Ana")
    assert harness.ask(go_on("Hanna", by_host=True)) == ""
    harness.pass_time(0.2)
    assert (harness.status().barrier, harness.status().stop.name) == (BARRIER_PHASE_STOPPED, "Ana")
    assert harness.ask(go_on("Ben")) == ""
    assert not harness.status().HasField("stop")
    assert notices(harness)[:2] == ["Hanna paused the room.", "Ana stopped everything."]


def test_a_pause_alone_is_ended_by_one_word(harness: RoomHarness) -> None:
    assert harness.ask(stop("Hanna", by_host=True)) == ""
    assert harness.ask(go_on("Hanna", by_host=True)) == ""
    harness.pass_time(0.2)
    assert harness.status().barrier != BARRIER_PHASE_STOPPED
    assert notices(harness) == ["Hanna paused the room.", "Hanna ended the pause: everything goes on."]


def test_a_host_lets_go_of_anybodys_stop(harness: RoomHarness) -> None:
    assert harness.ask(stop("Ana")) == ""
    assert harness.ask(go_on("Hanna", by_host=True)) == ""


def test_a_hosts_plan_counts_from_then_on_and_outlives_a_restart(world: World) -> None:
    task = world.task.name
    harness = RoomHarness(
        world, record=SavedRoom(seed=1, episodes=9, good=4).for_task(task).planned(task, 50)
    )
    assert harness.ask(planned(3)) == ""
    assert (harness.status().plan.episodes, harness.status().plan.good) == (3, 0)
    kept = harness.kept[-1]
    again = kept.for_task(task).planned(task, 50).plan  # the command that starts it still says 50
    assert again is not None
    assert (again.episodes, again.good_before) == (3, 4)
    other = kept.for_task(task).planned(task, 20).plan  # somebody starts it with another plan
    assert other is not None
    assert other.episodes == 20
    assert harness.ask(planned(0)) == ""
    assert not harness.status().HasField("plan")
    assert harness.kept[-1].for_task(task).planned(task, 50).plan is None
    assert [harness.ask(planned(many)) for many in (10_001, 2**32 - 1)] == ["InvalidInput", "InvalidInput"]
    assert notices(harness) == [
        "Hanna, the host, set the plan: 3 good episodes are wanted.",
        "Hanna, the host, set the plan: none is wanted.",
    ]
