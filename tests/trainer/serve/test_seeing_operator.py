"""A policy that sees is shown, in its seat, the state that it acts on."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mart.operators.commander import SeatCommander
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import OPERATOR_POLICY, Model, RoomStatus
from mart.render import PictureSpec, Renderer
from mart.sim.world import World
from mart.sim.world.model_message import model_message
from mart.trainer.serve.policy_seats import policy_commanders
from mart.trainer.serve.seeing_operator import SeeingOperator
from tests.sim.room.room_harness import RoomHarness
from tests.trainer.serve.toys import TASK, Array, Wanderer

pytestmark = pytest.mark.slow


class Seer(Wanderer):
    """Keeps the picture that it was shown last."""

    def __init__(self, viewpoint: str = "arm0") -> None:
        super().__init__(("arm0",))
        self.pictures = {"hand": PictureSpec(viewpoint, 48, 32)}
        self.shown: NDArray[np.uint8] | None = None

    def act(self, observations: Mapping[str, NDArray[Any]]) -> Array:
        self.shown = observations["hand"]
        return super().act(observations)


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


@pytest.fixture(scope="module")
def model(world: World) -> Model:
    return model_message(world)


def test_it_is_shown_the_very_state(world: World, model: Model) -> None:
    stage, policy = RoomHarness(world), Seer()
    operator = SeeingOperator(policy, model)
    operator.prepare()
    assert policy.shown is not None
    assert not policy.shown.any()  # it has acted once, on nothing
    commander = SeatCommander(operator, world.task, policy.arms, OPERATOR_POLICY, policy.needs)
    commander.seat({"arm0": 2})
    commander.observe(stage.newest)
    with closing(Renderer(world.model, "arm0", 48, 32)) as renderer:
        np.testing.assert_array_equal(policy.shown[0], renderer.draw(stage.newest.integration_state))


def test_a_viewpoint_that_is_not_there_is_told_before_the_seat_is_taken(model: Model) -> None:
    with pytest.raises(NotFound, match="moon"):
        SeeingOperator(Seer("moon"), model).prepare()


def test_promoted_policies_do_not_see() -> None:
    with pytest.raises(InvalidInput, match="mart operate"):
        policy_commanders(Seer(), RoomStatus(task=TASK, control_hz=20.0))
