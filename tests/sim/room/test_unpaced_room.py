"""A room on simulated time, its scripts in the same process, its words on a bus in memory."""

from __future__ import annotations

import threading
from collections import Counter
from functools import partial

import pytest

from mart.operators.driver import REPEAT_S
from mart.protocol import clock, codec, keys
from mart.protocol.messages import (
    OPERATOR_SCRIPT,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    Command,
    EpisodeRequest,
    Event,
    State,
)
from mart.runtime.bus.base import Handler
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork
from mart.runtime.skill_option import parse_people
from mart.sim.room.bus_publisher import OrderedPublisher
from mart.sim.room.episode_state_machine import COUNTDOWN_S, ENDED_S, Terms
from mart.sim.room.room import Room
from mart.sim.room.saved_room import SavedRoom
from mart.sim.room.unpaced_room import SimulatedTime, UnpacedRoom
from mart.sim.room.work_queue import WorkQueue
from mart.sim.world import World


class RoomHarness:
    """One room and all that it says, in order."""

    def __init__(self, world: World, skill: str = "expert", time_limit_s: float = 12.0) -> None:
        self.said: list[State | Event | Command] = []
        bus = MemoryNetwork().connect()
        self._subscribe(bus)
        self.time = SimulatedTime()
        publisher = OrderedPublisher(bus, "room-1", world.arms)
        terms = Terms(lockstep=True, skill=skill, time_limit_s=time_limit_s)
        self.room = Room(
            "room-1", world, SavedRoom(seed=5), publisher, lambda _: None, now_s=0.0, terms=terms
        )
        self.unpaced = UnpacedRoom(self.room, publisher, self.time, on_turn=lambda: None)
        self.unpaced.seat_scripts(world.task, parse_people(skill, 2), seed=5)

    def play(self, number: int) -> list[State]:
        """One episode; the states that are recorded of it."""
        self.ask(number)
        self.unpaced.play(threading.Event())
        return [said for said in self.said if isinstance(said, State) and said.episode == number]

    def ask(self, number: int) -> None:
        ready = EpisodeRequest(ready=EpisodeRequest.Ready(arm="arm0", ready=True, number=number))
        reply = self.room.answer_episode(ready, self.time.now_s())
        assert not reply.error.code, reply.error.message

    def event(self, what: str) -> Event:
        """The newest of its kind."""
        return next(said for said in reversed(self.said) if isinstance(said, Event) and said.HasField(what))

    def _subscribe(self, bus: MemoryBus) -> None:
        def into(kind: type[State | Event | Command]) -> Handler:
            return lambda sample: self.said.append(codec.decode(kind, sample.payload))

        bus.subscribe(keys.state("room-1").key, into(State))
        bus.subscribe(keys.event("room-1").key, into(Event))
        bus.subscribe(keys.commands("room-1"), into(Command))


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


def test_an_episode_is_driven_through_the_barrier_by_commands_like_anybodys(world: World) -> None:
    harness = RoomHarness(world)
    states = harness.play(1)
    first, *ticks = states
    assert (first.episode_tick, list(first.arms[0].action)) == (0, [])
    assert [state.episode_tick for state in ticks] == list(range(1, len(states)))
    assert harness.event("episode_ended").episode_ended.outcome == OUTCOME_SUCCESS
    said = {(c.arm, c.sequence) for c in harness.said if isinstance(c, Command)}
    used = {(arm.arm, arm.sequence) for state in ticks for arm in state.arms}
    assert used <= said
    assert len(used) == 2 * len(ticks)
    assert all(arm.source == OPERATOR_SCRIPT and arm.fresh for state in ticks for arm in state.arms)
    assert not harness.room.rejected


def test_scripts_are_heard_ten_times_a_second_while_the_world_stands_still(world: World) -> None:
    harness = RoomHarness(world, time_limit_s=0.2)
    harness.play(1)
    begun = harness.said.index(harness.event("episode_started"))
    heard = [said for said in harness.said[:begun] if isinstance(said, Command) and said.arm == "arm0"]
    assert len(heard) == pytest.approx(COUNTDOWN_S / REPEAT_S, abs=2)


def test_who_asks_before_an_episode_is_over_gets_the_next_one(world: World) -> None:
    harness, stop, work_queue = RoomHarness(world, time_limit_s=0.2), threading.Event(), WorkQueue()
    for number in (1, 2):
        work_queue.put(partial(harness.ask, number))
    work_queue.put(stop.set)
    harness.unpaced.run(work_queue, Counter(), stop)
    started = [said.episode_started.number for said in harness.said if isinstance(said, Event)]
    assert [number for number in started if number] == [1, 2]


def test_everything_is_said_in_the_order_in_which_it_happened(world: World) -> None:
    harness = RoomHarness(world)
    harness.play(1)
    begun = next(
        i for i, s in enumerate(harness.said) if isinstance(s, Event) and s.HasField("episode_started")
    )
    over = next(i for i, s in enumerate(harness.said) if isinstance(s, Event) and s.HasField("episode_ended"))
    recorded = [i for i, s in enumerate(harness.said) if isinstance(s, State) and s.episode == 1]
    assert begun < recorded[0]
    assert recorded[-1] < over


def test_the_event_tells_what_holds_here(world: World) -> None:
    harness = RoomHarness(world, "novice", time_limit_s=2.0)
    states = harness.play(3)
    started, ended = (
        harness.event("episode_started").episode_started,
        harness.event("episode_ended").episode_ended,
    )
    assert (started.lockstep, started.skill, started.time_limit_s) == (True, "novice", 2.0)
    assert (ended.outcome, ended.reason, ended.ticks) == (OUTCOME_FAILURE, "time is up", 40)
    assert len(states) == 41


@pytest.mark.slow
def test_the_same_number_gives_the_same_episode_whatever_came_before(world: World) -> None:
    one, other = RoomHarness(world, "novice"), RoomHarness(world, "novice")
    one.play(1)
    one.play(2)
    again = [state.integration_state for state in other.play(4)]
    assert again == [state.integration_state for state in one.play(4)]


def test_time_is_simulated_and_nobody_is_waited_for(world: World) -> None:
    harness = RoomHarness(world)
    began_s, began_sim_s = clock.monotonic_s(), harness.time.now_s()
    states = harness.play(1)
    real_s, simulated_s = clock.monotonic_s() - began_s, harness.time.now_s() - began_sim_s
    assert simulated_s == pytest.approx(COUNTDOWN_S + 0.05 * (len(states) - 1) + ENDED_S, abs=0.2)
    assert real_s < simulated_s
    assert states[-1].real_time_factor > 1.0
    waits = [said for said in harness.said if isinstance(said, Event) and said.HasField("barrier_changed")]
    assert not waits
    assert all(state.straggler_late_s == 0.0 for state in states)
