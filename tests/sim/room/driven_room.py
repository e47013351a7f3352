"""A room whose arms are driven, and the drivers of them as they look from the room."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from mart.protocol.messages import (
    DRIVER_PHASE_HOLDING,
    DRIVER_PHASE_STOPPED,
    ArmMeasured,
    ArmTarget,
    DriverHello,
    DriverPhase,
    EpisodeRequest,
)
from mart.protocol.wire_version import DRIVER_WIRE_VERSION
from mart.sim.room.driven_arms import ArmFacts, DrivenArms
from mart.sim.world import World
from mart.sim.world.driven_world import DrivenWorld
from tests.sim.room.room_harness import RoomHarness

HOME_RAD = [0.0, 0.2, 0.0, -2.1, 0.0, 2.3, 0.785]


def hello(
    arm: str = "arm0", instance: str = "a", other: Mapping[str, object] = MappingProxyType({})
) -> DriverHello:
    said = {"kind": "panda", "joints": 7, "model_sha256": "m", "wire_version": DRIVER_WIRE_VERSION, **other}
    return DriverHello(arm=arm, driver="OurArm", instance=instance, **said)  # type: ignore[arg-type]


class Drivers:
    """The drivers of some arms, as they look from the room."""

    def __init__(self, arms: tuple[str, ...] = ("arm0",)) -> None:
        self.told: list[ArmTarget] = []
        facts = {arm: ArmFacts("panda", 7, "m") for arm in arms}
        self.arms = DrivenArms("room-1", facts, 20.0, self._keep)
        self._sessions: dict[str, int] = {}
        self._sequence = 0
        self.fault = ""
        self.silent: set[str] = set()

    def _keep(self, target: ArmTarget) -> None:
        kept = ArmTarget()
        kept.CopyFrom(target)
        self.told.append(kept)

    def connect(self, now_s: float) -> None:
        for arm in self.arms.arms:
            self._sessions[arm] = self.arms.hello(hello(arm, instance=arm), now_s).session

    def measure(
        self, now_s: float, joints: list[float] = HOME_RAD, phase: DriverPhase = DRIVER_PHASE_HOLDING
    ) -> None:
        for arm in set(self.arms.arms) - self.silent:
            self._sequence += 1
            self.arms.hear(
                ArmMeasured(
                    arm=arm,
                    session=self._sessions[arm],
                    sequence=self._sequence,
                    joint_positions=joints,
                    phase=DRIVER_PHASE_STOPPED if self.fault else phase,
                    fault=self.fault,
                ),
                now_s,
            )


class DrivenRoom(RoomHarness):
    """A room whose arms are driven by drivers that measure 100 times a second."""

    def __init__(self, compiled: World, arms: tuple[str, ...] = ("arm0", "arm1")) -> None:
        self.drivers = Drivers(arms)
        super().__init__(DrivenWorld(compiled, self.drivers.arms), drivers=self.drivers.arms)

    def pass_time(self, elapsed_s: float) -> None:
        for _ in range(round(elapsed_s / 0.01)):
            if self.drivers._sessions:
                self.drivers.measure(self.now_s)
            super().pass_time(0.01)

    def opened(self) -> None:
        """Drivers connect, and a person lets it go on."""
        self.drivers.connect(self.now_s)
        self.pass_time(0.1)
        assert self.ask(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva"))) == ""
        for arm in ("arm0", "arm1"):
            self.take(arm)

    def texts(self) -> list[str]:
        return [event.notice.text for event in self.publisher.of("notice")]
