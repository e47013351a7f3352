"""Put a policy that sees into seats: what it is shown is drawn of the very state that it acts on."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mart.protocol.messages import Model
from mart.protocol.tasks import get_task
from mart.render import Image, StatePictures, load_model
from mart.trainer.models.policies.policy import Policy, pictures_of
from mart.trainer.serve.policy_operator import PolicyOperator


class SeeingOperator(PolicyOperator):
    """Drive the arms of one policy that sees. Prepare and use it on one thread: pictures are drawn there."""

    def __init__(self, policy: Policy, model: Model) -> None:
        """Drive in a room of this model."""
        super().__init__(policy, self._drawn)
        self._model = model

    def prepare(self) -> None:
        """Load the model and let the policy act once, on nothing that there is; see `Operator.prepare`.

        Raises NotFound for a viewpoint that the room has not, Unavailable where this machine draws nothing.
        """
        model, policy = self._model, self._policy
        loaded = load_model(
            model.mjb, sha256=model.sha256, mujoco_version=model.mujoco_version, source="the room"
        )
        self._pictures = StatePictures(loaded, pictures_of(policy))
        shapes = {one.name: one.shape for one in get_task(policy.task).observations}
        seen: dict[str, NDArray[Any]] = {name: np.zeros((1, *shapes[name])) for name in policy.needs}
        seen |= {
            name: np.zeros((1, one.height_px, one.width_px, 3), np.uint8)
            for name, one in pictures_of(policy).items()
        }
        policy.begin(1, seed=0)
        policy.act(seen)

    def _drawn(self, integration_state: bytes) -> dict[str, Image]:
        return self._pictures.draw(integration_state)
