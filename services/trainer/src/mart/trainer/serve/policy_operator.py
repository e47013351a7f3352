"""Put a policy into seats: an operator as any other, of one arm or of several together. Pure."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mart.operators.operator import Operator, SeatView, ToolTarget, target_from_action
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import Corrupt, InvalidInput

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy  # with all of torch behind it


DrawPictures = Callable[[bytes], Mapping[str, NDArray[np.uint8]]]


class PolicyOperator(Operator):
    """Drive the arms of one policy with one memory.

    Its action becomes an absolute target around the measured pose of the very state that it acted on, so what the sim
    applies is what the policy meant.
    """

    def __init__(self, policy: Policy, draw: DrawPictures | None = None) -> None:
        """Drive with a policy. draw: by name what a policy that sees is shown, of an integration state."""
        self._policy, self._draw = policy, draw

    def begin(self, episode: int) -> None:
        """Forget, and draw samples of this episode; see `Operator.begin`."""
        self._policy.begin(1, seed=episode)

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        """Return what the policy wants of all its arms. Raises Corrupt where that is not finite or misshapen."""
        observations: dict[str, NDArray[Any]] = {
            name: view.observations[name][np.newaxis] for name in self._policy.needs
        }
        if self._draw is not None:
            pictures = self._draw(view.integration_state)
            observations |= {name: picture[np.newaxis] for name, picture in pictures.items()}
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
