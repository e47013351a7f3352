"""A room whose people are far away, in simulated time: real worlds, scripts and barrier; packets by netrelay's rules.

Nothing waits for a clock, so a run says the same on any machine. Three ways to advance the world stand side by side:
ours (the barrier, commands streamed 60 times a second), request and reply (each tick is asked of everybody and waits
for all answers, sent again where they are lost, as TCP does), and hold-last (the world never waits).
"""

from __future__ import annotations

import heapq
import itertools
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from mart.protocol.messages import OPERATOR_SCRIPT, Command, CommandStamps
from mart.protocol.pose import Pose
from mart.sim.experts import Expert, get_skill
from mart.sim.room.barrier import Barrier
from mart.sim.room.command_age import CommandAge
from mart.sim.room.command_validation import ReceivedCommand
from mart.sim.room.pacing import Pace
from mart.sim.world import World
from tools.netrelay.impairment import LinkProfile
from tools.netrelay.packet_scheduler import PacketLoss, PacketScheduler

WAYS = ("barrier", "request_reply", "hold_last")
PHONE_PERIOD_S = 1 / 60
FRAME_BYTES, STATE_BYTES = 130, 1200
SHORTEST_RETRY_S = 0.2  # Linux's least TCP retransmission timeout, beyond the round trip
_EPOCH = 1


@dataclass
class RoomFigures:
    """What became of one episode. stale_s: of each applied command, since its person gave it; waits_s: by arm."""

    success: bool = False
    sim_s: float = 0.0
    wall_s: float = 0.0
    stale_s: list[float] = field(default_factory=list)
    waits_s: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    ticks_s: list[float] = field(default_factory=list)
    repeated: int = 0  # a command that had been applied before was applied again
    told_s: list[float] = field(default_factory=list)  # when everybody was told of a late person


class Clock:
    """Simulated time: what is due next happens next."""

    def __init__(self, began_s: float) -> None:
        self.now_s = began_s
        self._due: list[tuple[float, int, Callable[[], None]]] = []
        self._number = itertools.count()

    def at(self, when_s: float, act: Callable[[], None]) -> None:
        heapq.heappush(self._due, (max(when_s, self.now_s), next(self._number), act))

    def step(self) -> None:
        self.now_s, _, act = heapq.heappop(self._due)
        act()


class Leg:
    """One direction of a person's link."""

    def __init__(self, clock: Clock, scheduler: PacketScheduler) -> None:
        self._clock, self._scheduler = clock, scheduler
        self._round_trip_s = 2 * scheduler.impairment.delay_ms / 1e3

    def send(self, size: int, arrive: Callable[[], None], *, surely: bool = False, tries: int = 0) -> None:
        """`surely`: sent again until it arrives, after a time that doubles."""
        due = self._scheduler.schedule(round(self._clock.now_s * 1e9), size)
        if not isinstance(due, PacketLoss):
            self._clock.at(due / 1e9, arrive)
        elif surely:
            again_s = (self._round_trip_s + SHORTEST_RETRY_S) * 2**tries
            self._clock.at(
                self._clock.now_s + again_s, lambda: self.send(size, arrive, surely=True, tries=tries + 1)
            )


class DistantPerson:
    """A scripted person who sees states late and whose commands come late."""

    def __init__(self, world: World, arm: str, seed: int) -> None:
        skill = get_skill("expert")
        self.arm = arm
        self._expert = Expert(world.task, arm, skill, np.random.default_rng((seed, world.arms.index(arm))))
        self._target, self._gripper = world.tool_pose_in_base(arm), 0.0
        self._seen_tick = -1
        self._sequence = 0

    def see(self, tick: int, observations: Mapping[str, np.ndarray], sim_time_s: float) -> None:
        """A newer state than before is acted upon."""
        if tick <= self._seen_tick:
            return
        self._seen_tick = tick
        intent = self._expert.act(observations, sim_time_s)
        if intent.engaged:
            self._target = intent.pose_tool_in_base
        self._gripper = intent.gripper

    def say(self, now_s: float) -> tuple[Command, Pose]:
        self._sequence += 1
        stamps = CommandStamps(input_sent_ns=round(now_s * 1e9), sent_ns=round(now_s * 1e9))
        command = Command(
            arm=self.arm,
            seat_epoch=_EPOCH,
            sequence=self._sequence,
            gripper=self._gripper,
            stamps=stamps,
            state_tick=max(self._seen_tick, 0),
        )
        return command, self._target


class NetworkedRoom:
    """One episode of a world and its people, each behind a link of their own."""

    def __init__(
        self, world: World, way: str, profiles: Sequence[LinkProfile], seed: int, began_s: float
    ) -> None:
        """Begin at `began_s`: repeated outages end at multiples of their period."""
        world.reset(seed)
        self.figures = RoomFigures()
        self._world, self._way, self._began_s = world, way, began_s
        self._clock = Clock(began_s)
        self._people = [DistantPerson(world, arm, seed) for arm in world.arms]
        seeds = itertools.count(1000 * seed)
        self._legs = [
            tuple(Leg(self._clock, PacketScheduler(bad, next(seeds))) for bad in (profile.up, profile.down))
            for profile in profiles
        ]
        self._tick = 0
        self._pace = Pace(world.control_period_s, began_s)
        self._barrier = Barrier(world.arms, world.control_period_s, began_s)
        for arm in world.arms:
            self._barrier.seat(arm, OPERATOR_SCRIPT, _EPOCH, began_s)
        self._age = CommandAge(world.control_hz)
        self._newest: dict[str, ReceivedCommand] = {}
        self._applied: dict[str, int] = {}
        self._asked_s = began_s
        self._next_look_s = float("inf")

    def play(self, sim_limit_s: float, wall_limit_s: float) -> RoomFigures:
        """Run until success or one of the limits, seconds."""
        self._show()
        if self._way != "request_reply":
            for person, (up, _) in zip(self._people, self._legs, strict=True):
                self._stream(person, up)
        if self._way == "hold_last":
            self._clock.at(self._pace.due_s, self._tick_anyway)
        while (
            not self.figures.success
            and self._world.sim_time_s < sim_limit_s
            and self._clock.now_s - self._began_s < wall_limit_s
        ):
            self._clock.step()
        self.figures.sim_s = (self._tick - 1) * self._world.control_period_s  # from the first tick on
        self.figures.wall_s = self._clock.now_s - self.figures.ticks_s[0]
        return self.figures

    def _stream(self, person: DistantPerson, up: Leg) -> None:
        command, target = person.say(self._clock.now_s)
        up.send(FRAME_BYTES, lambda: self._hear(command, target))
        self._clock.at(self._clock.now_s + PHONE_PERIOD_S, lambda: self._stream(person, up))

    def _show(self) -> None:
        for person, (up, down) in zip(self._people, self._legs, strict=True):
            seen = self._world.observations_for(person.arm)
            arrive = self._arriving(person, up, self._tick, seen, self._world.sim_time_s)
            down.send(STATE_BYTES, arrive, surely=self._way == "request_reply")

    def _arriving(
        self, person: DistantPerson, up: Leg, tick: int, seen: Mapping[str, np.ndarray], sim_time_s: float
    ) -> Callable[[], None]:
        def arrive() -> None:
            person.see(tick, seen, sim_time_s)
            if self._way == "request_reply":
                command, target = person.say(self._clock.now_s)
                up.send(FRAME_BYTES, lambda: self._hear(command, target), surely=True)

        return arrive

    def _hear(self, command: Command, target: Pose) -> None:
        now_s = self._clock.now_s
        received = ReceivedCommand(command, target, now_s, round(now_s * 1e9))
        if self._way == "barrier":
            self._barrier.offer(received, too_old=self._age.objection(received, self._tick))
            self._look()
            return
        known = self._newest.get(received.arm)
        if known is None or known.sequence < received.sequence:
            self._newest[received.arm] = received
            self.figures.waits_s[received.arm] += max(0.0, now_s - max(self._pace.due_s, self._asked_s))
        if self._way == "request_reply" and self._all_new():
            self._clock.at(self._pace.due_s, self._tick_anyway)

    def _all_new(self) -> bool:
        return all(
            arm in self._newest and self._newest[arm].sequence > self._applied.get(arm, 0)
            for arm in self._world.arms
        )

    def _look(self) -> None:
        """Ask the barrier, as a room does: on every command, and when it says so."""
        now_s = self._clock.now_s
        decision = self._barrier.advance(now_s, gate_open=True)
        if decision.waiting_for and (not self.figures.told_s or now_s - self.figures.told_s[-1] > 1.0):
            self.figures.told_s.append(now_s)
        if decision.inputs is not None:
            if decision.inputs.straggler is not None:
                self.figures.waits_s[decision.inputs.straggler] += decision.inputs.late_s
            self._apply(decision.inputs.commands)
            decision = self._barrier.advance(now_s, gate_open=True)
        if decision.next_s < self._next_look_s or self._next_look_s <= now_s:
            self._next_look_s = decision.next_s
            if decision.next_s < float("inf"):
                self._clock.at(decision.next_s, self._look)

    def _tick_anyway(self) -> None:
        self._apply(self._newest)
        self._asked_s = self._clock.now_s
        self._pace.fired(self._clock.now_s)
        if self._way == "hold_last":
            self._clock.at(self._pace.due_s, self._tick_anyway)

    def _apply(self, commands: Mapping[str, ReceivedCommand]) -> None:
        world, now_s = self._world, self._clock.now_s
        actions = []
        for arm in world.arms:
            received = commands.get(arm)
            if received is None:  # nobody has said anything yet
                actions.append(world.action_for(arm, world.tool_pose_in_base(arm), 0.0))
                continue
            actions.append(world.action_for(arm, received.target_tool_in_base, received.command.gripper))
            self.figures.stale_s.append(now_s - received.command.stamps.input_sent_ns / 1e9)
            self.figures.repeated += self._applied.get(arm) == received.sequence
            self._applied[arm] = received.sequence
        self._tick += 1
        self.figures.ticks_s.append(now_s)
        self.figures.success = world.progress(world.step(np.array(actions))).success
        self._show()
