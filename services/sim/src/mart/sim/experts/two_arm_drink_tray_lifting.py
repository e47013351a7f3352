"""Takes the own handle, waits for the partner, and lifts in step; puts the tray down where the partner has let go."""

from __future__ import annotations

import numpy as np

from mart.protocol.tasks import Arm
from mart.sim.experts.carrying import Carrier
from mart.sim.experts.human_error import Person
from mart.sim.experts.plan import Plan, Sight

_LIFT_M = 0.14  # 10 cm would do; a loaded arm sags by 1 cm


def plan(arm: Arm, person: Person, sight: Sight) -> Plan:
    carrier = Carrier(arm, person)
    up = np.array([0.0, 0.0, _LIFT_M])
    while True:
        sight = yield from carrier.pick(sight)
        sight = yield from carrier.await_partner(sight)
        sight = yield from carrier.along(sight, up, until=lambda _: False)
