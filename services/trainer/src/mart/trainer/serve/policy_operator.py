"""Put a policy into seats: an operator as any other, of one arm or of several together. Pure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from mart.operators.operator import Operator, SeatView, ToolTarget, target_from_action
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import Corrupt, InvalidInput

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy  # with all of torch behind it


class PolicyOperator(Operator):
    """Drive the arms of one policy with one memory.

    Its action becomes an absolute target around the measured pose of the very state that it acted on, so what the sim
    applies is what the policy meant.
    """

    def __init__(self, policy: Policy) -> None:
        self._policy = policy

    def begin(self, episode: int) -> None:
        """Forget, and draw samples of this episode; see `Operator.begin`."""
        self._policy.begin(1, seed=episode)

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        """Return what the policy wants of all its arms. Raises Corrupt where that is not finite or misshapen."""
        observations = {name: view.observations[name][np.newaxis] for name in self._policy.needs}
        actions = self._policy.act(observations)
        arms = self._policy.arms
        if actions.shape != (1, len(arms), ACTION_SIZE) or not np.isfinite(actions).all():
            raise Corrupt(
                f"The policy's action of shape {actions.shape} is not of finite numbers for its arms."
            )
        return {
            arm: ToolTarget(
                *target_from_action(view.poses_tool_in_base[arm], action, view.task.arm(arm).kind.limits)
            )
            for arm, action in zip(arms, actions[0], strict=True)
        }


def parts_of(policy: Policy) -> tuple[Policy, ...]:
    """Return one policy an arm where each drives its own, the whole one where they are driven together."""
    try:
        return tuple(policy.only(arm) for arm in policy.arms)
    except InvalidInput:
        return (policy,)
