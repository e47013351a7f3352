"""Keep the worlds that were compiled last: compiling one takes most of a second, and each takes tens of megabytes."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

from mart.sim.world import World

MAX_COMPILED = 8


@dataclass(frozen=True)
class WorldSpec:
    """Name what decides a world's model."""

    task: str
    control_hz: float
    arms: int | None
    kinds: tuple[str, ...] = ()


class CompiledWorlds:
    """Compile worlds as they are asked for and keep the `MAX_COMPILED` that were asked for last."""

    def __init__(self) -> None:
        self._worlds: OrderedDict[WorldSpec, World] = OrderedDict()

    def get(self, spec: WorldSpec) -> World:
        """Return the world; raises NotFound for an unknown task or kind, InvalidInput for an impossible rate."""
        world = self._worlds.get(spec)
        if world is None:
            world = World.build(spec.task, spec.control_hz, spec.arms, kinds=spec.kinds)
        self._worlds[spec] = world
        self._worlds.move_to_end(spec)
        while len(self._worlds) > MAX_COMPILED:
            self._worlds.popitem(last=False)
        return world
