"""Plan drink tray lifting: grip the own handle, wait for the partner, lift in step; down where the partner let go."""

from __future__ import annotations

import numpy as np

from mart.protocol.tasks import Arm
from mart.sim.experts.carrying import Carrier
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.plan import ExpertPlan, OperatorObservation

_LIFT_M = 0.14  # 10 cm would do; a loaded arm sags by 1 cm


def plan(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    """Yield the waypoints of one arm."""
    carrier = Carrier(arm, human)
    up = np.array([0.0, 0.0, _LIFT_M])
    while True:
        obs = yield from carrier.pick(obs)
        obs = yield from carrier.await_partner(obs)
        obs = yield from carrier.along(obs, up, until=lambda _: False)
