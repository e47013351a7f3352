"""Put the drivers of a room's arms on the bus."""

from __future__ import annotations

from collections.abc import Sequence

from mart.protocol import codec, keys
from mart.protocol.messages import ArmTarget
from mart.runtime.bus import Bus
from mart.runtime.bus.base import Publisher
from mart.sim.room.driven_arms import ArmFacts, DrivenArms
from mart.sim.world import World

_KIND = "panda"


class BusDrivers(DrivenArms):
    """Keep the drivers of `arms`, and publish what they are told once a bus is there.

    Raises NotFound for an arm that the world does not have.
    """

    def __init__(self, room: str, world: World, arms: Sequence[str]) -> None:
        facts = {world.task.arm(arm).name: _facts(world, arm) for arm in sorted(set(arms))}
        super().__init__(room, facts, world.control_hz, self._publish)
        self._publishers: dict[str, Publisher] = {}

    def publish_on(self, bus: Bus) -> BusDrivers:
        """Publish on this bus from now on, until `close`."""
        self._publishers = {arm: bus.publisher(keys.arm_target(self._room, arm)) for arm in self.arms}
        return self

    def close(self) -> None:
        """Publish nothing any more."""
        publishers, self._publishers = self._publishers, {}
        for publisher in publishers.values():
            publisher.close()

    def _publish(self, target: ArmTarget) -> None:
        publisher = self._publishers.get(target.arm)
        if publisher is not None:
            publisher.put(codec.encode(target))


def _facts(world: World, arm: str) -> ArmFacts:
    names = (world.model.joint(index).name for index in range(world.model.njnt))
    joints = sum(name.startswith(f"{arm}/joint") for name in names)
    return ArmFacts(_KIND, joints, world.model_sha256)
