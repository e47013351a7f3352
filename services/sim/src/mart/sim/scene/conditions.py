"""Judge the conditions of a task file in the data of a world or a batch. Shapes (...) are as in `Scene`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from mart.protocol.tasks.conditions import (
    Above,
    Below,
    Condition,
    Held,
    Inside,
    Near,
    Released,
    Still,
    Upright,
)
from mart.protocol.tasks.task import Arm
from mart.protocol.tasks.task_file import WORLD, Region
from mart.sim.scene.data import Array, Data, Flags, length, within
from mart.sim.scene.scene import all_of
from mart.sim.scene.things import Thing, Tool

Judge = Callable[[], Flags]

_NOTHING_HELD_M = 0.004  # so narrow a gap holds nothing
_OPEN = 0.95  # of the gap between open fingers: they hold nothing either


class ConditionJudge:
    """Look up once what conditions name; `judge` makes of them what ticks call.

    body: the name in the model of what a file calls so.
    """

    def __init__(
        self,
        data: Data,
        objects: Sequence[str],
        arms: Sequence[Arm],
        regions: Sequence[Region],
        body: Callable[[str], str],
    ) -> None:
        self._data, self._in_model = data, body
        self.things: Mapping[str, Thing] = {name: Thing(data, body(name)) for name in objects}
        self._tools = {arm.name: Tool(data, arm) for arm in arms if arm.kind.has_fingers}
        self._tool_positions = [data.site(f"{arm.name}/tool").xpos for arm in arms]
        self._regions = {region.name: region for region in regions}

    def judge(self, conditions: Sequence[Condition]) -> Judge:
        """Return a function that says where all of these hold, flags of shape (...)."""
        judges = [self._one(condition) for condition in conditions]
        return lambda: all_of(one() for one in judges)

    def _one(self, asked: Condition) -> Judge:  # noqa: PLR0911 - one for each sort
        match asked:
            case Inside():
                return self._inside(self.things[asked.object], self._regions[asked.region])
            case Above() | Below():
                thing, sign = self.things[asked.object], 1.0 if isinstance(asked, Above) else -1.0
                return lambda: sign * (thing.position[..., 2] - asked.z_m) > 0.0
            case Near():
                thing, other = self.things[asked.object], self.things[asked.other]
                return lambda: length(thing.position - other.position) <= asked.within_m
            case Upright():
                thing, least = self.things[asked.object], float(np.cos(asked.within_rad))
                return lambda: thing.uprightness > least
            case Still():
                velocity = self._data.joint(self._in_model(asked.object)).qvel
                return lambda: length(velocity[..., :3]) < asked.below_m_s
            case Held():
                thing, tool = self.things[asked.object], self._tools[asked.by]
                return lambda: _holds(tool) & (length(tool.position - thing.position) <= asked.within_m)
            case Released():
                thing = self.things[asked.object]
                tools = self._tool_positions
                return lambda: all_of(length(tool - thing.position) > asked.beyond_m for tool in tools)
        position = self._data.joint(self._in_model(asked.joint)).qpos
        low = -np.inf if asked.at_least is None else asked.at_least
        high = np.inf if asked.at_most is None else asked.at_most
        return lambda: (position[..., 0] >= low) & (position[..., 0] <= high)

    def _inside(self, thing: Thing, region: Region) -> Judge:
        center, half = np.array(region.center_m), np.array(region.half_m)
        if region.frame == WORLD:
            return lambda: within(thing.position - center, half)
        around = self.things[region.frame]
        return lambda: within(around.frame(thing.position) - center, half)


def _holds(tool: Tool) -> Flags:
    width: Array = tool.width_m
    return (width > _NOTHING_HELD_M) & (width < _OPEN * tool.open_m)
