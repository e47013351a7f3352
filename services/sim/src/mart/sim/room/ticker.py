"""Advance the world by one tick, or reset it, and say how it is afterwards."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from mart.protocol import clock
from mart.protocol.messages import State, TickStamps
from mart.sim.room import room_messages
from mart.sim.room.barrier import TickInputs
from mart.sim.room.command_validation import ReceivedCommand
from mart.sim.room.episode_state_machine import EpisodeStateMachine
from mart.sim.room.pacing import RealTimeFactor
from mart.sim.room.seats import SeatTable
from mart.sim.room.targets import Targets
from mart.sim.world import TaskProgress, World

NOBODY: Mapping[str, ReceivedCommand] = MappingProxyType({})


class Ticker:
    """Step the world; `tick` counts the states of this run of the sim, those after resets included.

    Where a room is opened anew, it counts on from the `tick` that is given.
    """

    def __init__(self, room: str, world: World, boot_ns: int, now_s: float, tick: int = 0) -> None:
        self.tick = tick
        self.progress: TaskProgress | None = None
        self._room = room
        self._world = world
        self._boot_ns = boot_ns
        self._targets = Targets(world)
        self._real_time_factor = RealTimeFactor(world.control_period_s, now_s)

    def real_time_factor(self, now_s: float) -> float:
        """Return simulated over wall time of about the last 2 s, at most since the world last began or resumed."""
        return self._real_time_factor.value(now_s)

    def reset(self, seed: int, seats: SeatTable, episode: EpisodeStateMachine, now_s: float) -> State:
        """Reset the world; return the state of the fresh one."""
        self._world.reset(seed)
        self._targets.world_reset()
        return self.standing(seats, episode, now_s)

    def standing(self, seats: SeatTable, episode: EpisodeStateMachine, now_s: float) -> State:
        """Return the state of the world as it is, before it begins to run."""
        self._real_time_factor.restart(now_s)
        wall_ns = clock.wall_ns()
        stamps = TickStamps(fired_ns=wall_ns, stepped_ns=wall_ns)
        return self._state(seats, episode, now_s, self._world.progress(), stamps=stamps)

    @property
    def keeps_score(self) -> bool:
        """Whether the task tells how long its subtasks take, and how many tries."""
        return self.progress is not None and bool(self.progress.scores)

    def aim(self, received: ReceivedCommand) -> None:
        """Work out beforehand what an accepted command asks for."""
        self._targets.aim(received)

    def advance(
        self, inputs: TickInputs, seats: SeatTable, episode: EpisodeStateMachine, now_s: float
    ) -> State:
        """Advance one control period and return the state; raises Diverged where the physics left its bounds."""
        fired_ns = clock.wall_ns()
        actions = self._targets.actions(inputs.commands)
        status = self._world.step(actions)
        stamps = TickStamps(
            due_ns=fired_ns - round((now_s - inputs.due_s) * 1e9),
            fired_ns=fired_ns,
            stepped_ns=clock.wall_ns(),
        )
        if inputs.resumed:  # waiting for people to begin is not slowness
            self._real_time_factor.restart(now_s)
        self._real_time_factor.ticked(now_s)
        progress = self._world.progress(status)
        state = self._state(
            seats, episode, now_s, progress, stamps=stamps, commands=inputs.commands, actions=actions
        )
        state.straggler = inputs.straggler or ""
        state.straggler_late_s = inputs.late_s
        if episode.recording:
            state.episode_tick = episode.ticks + 1
        return state

    def _state(
        self,
        seats: SeatTable,
        episode: EpisodeStateMachine,
        now_s: float,
        progress: TaskProgress,
        *,
        stamps: TickStamps,
        commands: Mapping[str, ReceivedCommand] = NOBODY,
        actions: NDArray[np.float64] | None = None,
    ) -> State:
        self.tick += 1
        self.progress = progress
        seen = self._world.observations()
        return State(
            room=self._room,
            tick=self.tick,
            sim_time_s=self._world.sim_time_s,
            stamps=stamps,
            real_time_factor=self.real_time_factor(now_s),
            integration_state=self._world.integration_state(),
            arms=[
                room_messages.arm_state(
                    seen,
                    seat,
                    commands.get(seat.arm),
                    () if actions is None else actions[index].tolist(),
                )
                for index, seat in enumerate(seats)
            ],
            observations=room_messages.observations(seen),
            progress=room_messages.progress(progress),
            episode=episode.number if episode.recording else 0,
            boot=self._boot_ns,
        )
