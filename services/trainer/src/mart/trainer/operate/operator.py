"""A policy that drives seats of one room, as people and scripts do. Pure: states in, commands out.

The policy acts once for every state. Its action becomes an absolute target around the measured pose of that very state,
so that what the sim applies is what the policy meant, and a command that is lost, repeated or overtaken does no harm.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import (
    OPERATOR_POLICY,
    ArmState,
    Command,
    CommandStamps,
    PoseMessage,
    State,
    pose_from_message,
    pose_message,
)
from mart.protocol.pose import Pose, quaternion_exp, quaternion_multiply
from mart.protocol.tasks import Limits, Task

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy

Array = NDArray[np.float64]


class PolicyOperator:
    """One policy with one memory: all arms of a joint one, one arm of a per-arm one.

    A joint policy of which people hold some arms goes on with the others: it acts for all and commands its own. It
    remembers what it saw as long as it holds a seat and the world is not reset.
    """

    def __init__(self, policy: Policy, task: Task) -> None:
        self.arms = policy.arms
        self._policy, self._task = policy, task
        self._epochs: Mapping[str, int] = {}
        self._sequences = dict.fromkeys(policy.arms, 0)
        self._targets: dict[str, tuple[PoseMessage, float]] = {}  # pose and gripper
        self._seen = (0, 0, 0.0)  # boot, tick, simulated seconds
        self._begun = False

    def seat(self, epochs: Mapping[str, int]) -> None:
        """The seats that it holds now, arm → epoch; of other arms nothing is said."""
        self._epochs = {arm: epochs[arm] for arm in self.arms if arm in epochs}
        self._begun = self._begun and bool(self._epochs)

    def see(self, state: State) -> bool:
        """Whether `state` was news. Raises Corrupt or InvalidInput where the policy cannot act on it."""
        seen = (state.boot, state.tick, state.sim_time_s)
        if not self._epochs or seen[:2] == self._seen[:2]:
            return False
        arms = {arm.arm: arm for arm in state.arms}
        missing = [arm for arm in self.arms if arm not in arms]
        if missing:
            raise Corrupt(f"A state without {', '.join(missing)} came, which the policy drives.")
        if not self._begun or self._world_was_reset(state, arms[self.arms[0]]):
            self._policy.begin(1, seed=state.episode)
            self._begun = True
        self._seen = seen
        actions = self._act(state)
        for arm, action in zip(self.arms, actions, strict=True):
            measured = pose_from_message(arms[arm].tool_in_base)
            target, gripper = target_of(measured, action, self._task.limits)
            self._targets[arm] = pose_message(target), gripper
            # Whoever drove under this epoch before has counted so far.
            self._sequences[arm] = max(self._sequences[arm], arms[arm].sequence)
        return True

    def commands(self, wall_ns: int) -> list[Command]:
        """What it wants now, one command a seat, under new numbers; none before it has seen anything."""
        wanted = self._epochs.keys() & self._targets.keys() if self._begun else ()
        return [self._command(arm, wall_ns) for arm in sorted(wanted)]

    def _act(self, state: State) -> Array:
        actions = self._policy.act(sight_of(state, self._task, self._policy.needs))
        if actions.shape != (1, len(self.arms), 7) or not np.isfinite(actions).all():
            raise Corrupt(
                f"The policy's action of shape {actions.shape} is not of finite numbers for its arms."
            )
        return actions[0]

    def _world_was_reset(self, state: State, mine: ArmState) -> bool:
        boot, _, sim_time_s = self._seen
        return not mine.action or state.boot != boot or state.sim_time_s < sim_time_s

    def _command(self, arm: str, wall_ns: int) -> Command:
        target, gripper = self._targets[arm]
        self._sequences[arm] += 1
        return Command(
            arm=arm,
            seat_epoch=self._epochs[arm],
            sequence=self._sequences[arm],
            target_tool_in_base=target,
            gripper=gripper,
            engaged=True,
            source=OPERATOR_POLICY,
            stamps=CommandStamps(sent_ns=wall_ns),
            seen_tick=self._seen[1],
        )


def target_of(measured_tool_in_base: Pose, action: Array, limits: Limits) -> tuple[Pose, float]:
    """The target pose in the arm's base and the gripper (0 open … 1 closed) that `action`, shape (7,), asks for.

    The inverse of what the sim applies (docs/protocol.md, section "Commands"): within the limits and the workspace the
    applied action is this action again.
    """
    turn = quaternion_exp(limits.step_rad * action[3:6])
    pose = Pose(
        measured_tool_in_base.position + limits.step_m * action[:3],
        quaternion_multiply(turn, measured_tool_in_base.quaternion_wxyz),
    )
    return pose, min(max((float(action[6]) + 1.0) / 2.0, 0.0), 1.0)


def parts_of(policy: Policy) -> tuple[Policy, ...]:
    """One policy an arm where each drives its own, the whole one where they are driven together."""
    try:
        return tuple(policy.only(arm) for arm in policy.arms)
    except InvalidInput:
        return (policy,)


def sight_of(state: State, task: Task, needs: tuple[str, ...]) -> dict[str, Array]:
    """The observations named `needs`, each of shape (1, *shape). Raises Corrupt where one is missing or misshapen."""
    values = {observation.name: observation.value for observation in state.observations}
    shapes = {observation.name: observation.shape for observation in task.observations}
    try:
        return {name: np.array(values[name], dtype=np.float64).reshape(1, *shapes[name]) for name in needs}
    except (KeyError, ValueError) as error:
        raise Corrupt(f"A state came without what the policy should see: {error}.") from error
