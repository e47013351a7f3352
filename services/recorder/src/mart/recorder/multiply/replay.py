"""Play what was composed in many worlds at once, on replicas, and keep every state. Each batch is its seeds' alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mart.protocol.batch_state import ACTION_SIZE, BatchState, Flags
from mart.protocol.pose import (
    Array,
    Pose,
    quaternion_conjugate,
    quaternion_log,
    quaternion_multiply,
    rotate,
)
from mart.protocol.tasks import Arm, Task
from mart.recorder.multiply.carried_segment import Placed
from mart.recorder.multiply.composition import Composer, WayPiece
from mart.recorder.multiply.demonstration import ToolInWorld, things_of, tool_in_world, track_of
from mart.recorder.multiply.references import Reference
from mart.recorder.multiply.segments import SegmentKind
from mart.recorder.multiply.transport import yaw_of
from mart.recorder.multiply.way_player import WayPlayer
from mart.rollouts.client import RolloutClient

_AFTER_S = 2.0  # in which a task may still come to be done after the ways are at their ends


@dataclass(frozen=True)
class PlayedWorld:
    """Hold how one world went, T ticks, T + 1 states: of each the rows of `BatchState`. reason: why it failed."""

    seed: int
    pieces: Mapping[str, tuple[WayPiece, ...]]
    succeeded: bool
    reason: str
    observations: Mapping[str, Array]
    subtasks: Flags
    sim_time_s: Array
    integration_states: Array
    actions: Array


@dataclass(frozen=True)
class Replayer:
    """Play episodes of a task. time_limit_s: of one episode, simulated."""

    client: RolloutClient
    task: Task
    control_hz: float
    composer: Composer
    references: Mapping[SegmentKind, Reference]
    time_limit_s: float

    def play(self, seeds: Sequence[int], on_tick: Callable[[], None] = lambda: None) -> list[PlayedWorld]:
        """Play one episode for each seed, which decides its world and what it is made of."""
        state = self.client.reset(
            self.task.name,
            seeds,
            self.control_hz,
            len(self.task.arms),
            arm_kinds=self.task.arm_kinds,
            integration_states=True,
        )
        players = [self._player(seed, state, world) for world, seed in enumerate(seeds)]
        history = [state]
        actions: list[Array] = []
        running = np.ones(len(seeds), bool)
        ended_ticks = np.zeros(len(seeds), int)
        over_ticks = np.zeros(len(seeds), int)
        for tick in range(1, round(self.time_limit_s * self.control_hz) + 1):
            step = np.zeros((len(seeds), len(self.task.arms), ACTION_SIZE))
            for world in np.flatnonzero(running):
                step[world] = self._actions(players[world], state, int(world))
            state = self.client.step(step, running)
            history.append(state)
            actions.append(step)
            ended_ticks[running] = tick
            over_ticks += np.array([player.done for player in players])
            late = over_ticks > _AFTER_S * self.control_hz
            running &= ~(state.success | state.failed | late)
            on_tick()
            if not running.any():
                break
        return [
            self._played(world, seed, players[world], history[: ended_ticks[world] + 1], actions)
            for world, seed in enumerate(seeds)
        ]

    def _player(self, seed: int, state: BatchState, world: int) -> WayPlayer:
        pieces = self.composer.compose(self._placed(state, world), np.random.default_rng([seed, 1]))
        lasts = {arm.name: _measured(arm, state, world) for arm in self.task.arms}
        return WayPlayer(self.task, pieces, self.references, lasts)

    def _actions(self, player: WayPlayer, state: BatchState, world: int) -> Array:
        done = [
            one.name
            for one, is_done in zip(self.task.subtasks, state.subtasks[world], strict=True)
            if is_done
        ]
        targets = player.targets(self._placed(state, world), done)
        return np.array([_action(arm, targets[arm.name], state, world) for arm in self.task.arms])

    def _placed(self, state: BatchState, world: int) -> dict[str, Placed]:
        found = {}
        for thing in things_of(self.task):
            track = track_of(thing, state.observations)
            turn = None if track.quaternions is None else yaw_of(track.quaternions[world])
            found[thing] = Placed(track.positions[world], turn)
        return found

    def _played(
        self, world: int, seed: int, player: WayPlayer, own: Sequence[BatchState], actions: Sequence[Array]
    ) -> PlayedWorld:
        """Return how a world went. own: the states while it ran; actions: of all worlds, as many or more."""
        last = own[-1]
        states = [one.integration_states[world] for one in own if one.integration_states is not None]
        return PlayedWorld(
            seed=seed,
            pieces=player.pieces,
            succeeded=bool(last.success[world]),
            reason=last.reasons[world] or ("" if last.success[world] else "the carried ways did not do it"),
            observations={
                name: np.array([one.observations[name][world] for one in own]) for name in last.observations
            },
            subtasks=np.array([one.subtasks[world] for one in own]),
            sim_time_s=np.array([one.sim_time_s[world] for one in own]),
            integration_states=np.array(states),
            actions=np.array([one[world] for one in actions[: len(own) - 1]]),
        )


def _tool_in_base(arm: str, state: BatchState, world: int) -> tuple[Array, Array]:
    return (
        state.observations[f"{arm}/tool_position_in_base"][world],
        state.observations[f"{arm}/tool_quaternion_in_base"][world],
    )


def _measured(arm: Arm, state: BatchState, world: int) -> ToolInWorld:
    return tool_in_world(arm, *_tool_in_base(arm.name, state, world))


def _action(arm: Arm, target: ToolInWorld, state: BatchState, world: int) -> Array:
    """Return the action, shape (7,), from the measured pose towards a target, within workspace and limits."""
    base = arm.pose_base_in_world.inverse()
    wanted = arm.kind.workspace.clamp(
        Pose(
            base.position + rotate(base.quaternion_wxyz, target.position),
            quaternion_multiply(base.quaternion_wxyz, target.quaternion),
        )
    )
    position, quaternion = _tool_in_base(arm.name, state, world)
    turn = quaternion_multiply(wanted.quaternion_wxyz, quaternion_conjugate(quaternion))
    shift = (wanted.position - position) / arm.kind.limits.step_m
    turned = quaternion_log(turn) / arm.kind.limits.step_rad
    return np.concatenate([_within_unit(shift), _within_unit(turned), [2.0 * target.gripper - 1.0]])


def _within_unit(vector: Array) -> Array:
    return vector / max(1.0, float(np.linalg.norm(vector)))
