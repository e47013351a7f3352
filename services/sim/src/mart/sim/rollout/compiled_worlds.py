"""Keep the worlds that were compiled last: compiling one takes most of a second, and each takes tens of megabytes."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

from mart.protocol.errors import InvalidInput, Unavailable
from mart.protocol.tasks import recorded_task
from mart.sim.tasks import scene_of
from mart.sim.world import World

MAX_COMPILED = 8


@dataclass(frozen=True)
class RecordedWorld:
    """Hold what a recording of somebody's own task carries: its task file, and the compiled model with its digest."""

    task_file: bytes
    mjb: bytes
    sha256: str


@dataclass(frozen=True)
class WorldSpec:
    """Name what decides a world's model."""

    task: str
    control_hz: float
    arms: int | None
    kinds: tuple[str, ...] = ()
    recorded: RecordedWorld | None = None


class CompiledWorlds:
    """Compile worlds as they are asked for and keep the `MAX_COMPILED` that were asked for last."""

    def __init__(self) -> None:
        self._worlds: OrderedDict[WorldSpec, World] = OrderedDict()

    def get(self, spec: WorldSpec) -> World:
        """Return the world; raises NotFound for an unknown task or kind, InvalidInput for an impossible rate."""
        world = self._worlds.get(spec)
        if world is None:
            world = _compile(spec)
        self._worlds[spec] = world
        self._worlds.move_to_end(spec)
        while len(self._worlds) > MAX_COMPILED:
            self._worlds.popitem(last=False)
        return world


def _compile(spec: WorldSpec) -> World:
    """Compile a world, or take the one that was recorded: nothing of a recording needs to be here."""
    if spec.recorded is None:
        return World.build(spec.task, spec.control_hz, spec.arms, kinds=spec.kinds)
    try:
        from mart.render import load_model
    except ImportError as error:
        raise Unavailable(
            f"{spec.task} is somebody's own task, whose recorded model this replica cannot load: "
            "pip install mart-sim[render]."
        ) from error
    recorded = spec.recorded
    model = load_model(
        recorded.mjb,
        sha256=recorded.sha256,
        mujoco_version="another version",
        source=f"a recording of {spec.task}",
    )
    task = recorded_task(spec.task, recorded.task_file, spec.kinds)
    try:
        return World(scene_of(task), spec.control_hz, compiled=model)
    except KeyError as error:
        raise InvalidInput(
            f"The recorded model of {spec.task} has not what its task file names: {error}."
        ) from error
