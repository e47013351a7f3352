"""Build the handover: two shelves; a hammer under a lid on the one, a bin with a trash cube on the other."""

from __future__ import annotations

from collections.abc import Container
from itertools import product

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import MAX_ARMS, Arm
from mart.sim.scene.data import Array, Data, Flags, length, within
from mart.sim.scene.gripper import GRASPABLE
from mart.sim.scene.palette import rgba
from mart.sim.scene.scene import Scene, TaskStatus, all_of
from mart.sim.scene.shadows import add_shadow
from mart.sim.scene.symbols import add_tile
from mart.sim.scene.things import Thing, Tool

SHELF_Z_M = 0.06
_SHELF_X_M, _SHELF_HALF_M = 0.27, (0.23, 0.36)

# Open boxes: centre (x, y), inner half sizes. The shelf is their floor. Far enough apart that a hammer which was
# dropped on its way can be gripped between them.
CONTAINER, BIN, TRASH_TRAY = (-0.27, 0.20), (0.27, 0.20), (0.27, -0.18)
_CONTAINER_HALF_M, BIN_HALF_M, TRASH_TRAY_HALF_M = (0.155, 0.09), (0.165, 0.09), (0.07, 0.07)
_WALL_HALF_M, _WALL_HEIGHT_M = 0.005, 0.045
_INSIDE_Z_M = SHELF_Z_M + 0.05

_LID_HALF_M = (0.165, 0.10, 0.004)
KNOB_HALF_M = (0.03, 0.012, 0.02)
KNOB_Z_M = _LID_HALF_M[2] + KNOB_HALF_M[2]  # of its middle, in the lid
# Balls under the lid: on the rim of the walls, and inside their corners, where they keep it from sliding off.
_RIM_RADIUS_M, _CORNER_RADIUS_M, _CORNER_PLAY_M = 0.004, 0.005, 0.003
_LID_Z_M = SHELF_Z_M + _WALL_HEIGHT_M + _RIM_RADIUS_M + _LID_HALF_M[2]

HANDLE_HALF_M, _HEAD_HALF_M, _HEAD_X_M = (0.11, 0.011, 0.010), (0.015, 0.034, 0.015), -0.125
TRASH_HALF_M = 0.02

LIFTED_M = SHELF_Z_M + 0.10
_LID_AWAY_M, _RELEASED_WIDTH_M, _RELEASED_M = 0.20, 0.06, 0.20
# A handle is in the hand where the pads' middle is in it, give or take, and the pads are as far apart as it is wide.
_GRIP_M = (HANDLE_HALF_M[0], 0.008, 0.020)
_GRIP_WIDTH_M = (2 * HANDLE_HALF_M[1] - 0.005, 2 * HANDLE_HALF_M[1] + 0.006)
_HELD_BY_BOTH, _HANDED_OVER = 1.0, 2.0

_TOO_FAR_M = 0.01  # along the handle, away from its head: two hands would meet
_BOTH_HOLD = {
    "arm0": "Your partner has it: let go now.",
    "arm1": "Hold it still until your partner has let go.",
}

# From where an arm usually begins, in its base: to where its hand hides neither knob nor trash from its camera.
_ASIDE_M = {"arm0": (0.0, -0.16, 0.06), "arm1": (0.0, 0.16, 0.06)}

_FIRM = {"solref": (0.004, 1.0)}
_GHOST = {"contype": 0, "conaffinity": 0, "mass": 0.0}
_BOX, _SPHERE = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_SPHERE


class PickPlaceHandover(Scene):
    """Define the scene of the handover."""

    memory_size = 1  # how far the handover has come

    def add_objects(self, spec: mujoco.MjSpec) -> None:
        fetcher, receiver = self.task.arms
        for x in (-_SHELF_X_M, _SHELF_X_M):
            spec.worldbody.add_geom(
                type=_BOX,
                size=(*_SHELF_HALF_M, SHELF_Z_M / 2),
                pos=(x, 0, SHELF_Z_M / 2),
                material="linen",
            )
        _add_open_box(spec, "container", _CONTAINER_HALF_M, material="paint", rgba=rgba(fetcher.color))
        _add_open_box(spec, "bin", BIN_HALF_M, material="paint", rgba=rgba(receiver.color))
        _add_open_box(spec, "trash_tray", TRASH_TRAY_HALF_M, material="slate")
        lid = _add_lid(spec)
        for side in (-1, 1):
            position = (0.0, KNOB_HALF_M[1] * side, KNOB_Z_M)
            add_tile(spec, lid, fetcher.symbol, radius_m=0.011, position=position, normal=(0, side, 0))
        _add_hammer(spec)
        trash = spec.worldbody.add_body(name="trash", pos=(*BIN, SHELF_Z_M + TRASH_HALF_M))
        trash.add_freejoint(name="trash")
        trash.add_geom(type=_BOX, size=(TRASH_HALF_M,) * 3, mass=0.05, material="clay", **GRASPABLE)

    def attach(self, data: Data) -> None:
        self._stage = self.memory(data)[..., 0]
        self._container, self._bin, self._trash_tray = (
            Thing(data, name) for name in ("container", "bin", "trash_tray")
        )
        self._lid, self._hammer, self._trash = (Thing(data, name) for name in ("lid", "hammer", "trash"))
        self._tools = {arm.name: Tool(data, arm) for arm in self.task.arms}

    def place_objects(self, random: np.random.Generator) -> None:
        boxes = (self._container, self._bin, self._trash_tray)
        places = [place + random.uniform(-0.01, 0.01, 2) for place in (CONTAINER, BIN, TRASH_TRAY)]
        for box, place in zip(boxes, places, strict=True):
            box.put((*place, SHELF_Z_M))
        container, bin_, _ = places
        self._lid.put((*container, _LID_Z_M))
        x, y = container + random.uniform(
            (0.0, -0.012), (0.024, 0.012)
        )  # its origin is not the middle of its length
        self._hammer.put((x, y, SHELF_Z_M + _HEAD_HALF_M[2]), random.uniform(-0.2, 0.2))
        x, y = bin_ + random.uniform(-1.0, 1.0, 2) * (0.06, 0.03)
        self._trash.put((x, y, SHELF_Z_M + TRASH_HALF_M), random.uniform(-0.6, 0.6))

    def start_pose_in_base(self, arm: Arm, random: np.random.Generator) -> Pose:
        start = super().start_pose_in_base(arm, random)
        return Pose(start.position + _ASIDE_M[arm.name], start.quaternion_wxyz)

    def observe(self) -> dict[str, Array]:
        observations = {f"{arm}/tool_position_in_world": tool.position for arm, tool in self._tools.items()}
        for thing in (self._container, self._bin, self._trash_tray, self._lid, self._hammer, self._trash):
            observations |= thing.observations()
        return observations

    def remember(self) -> None:
        """Note the handover: both held it in the air, then arm 1 alone; nobody threw it or laid it down between."""
        fetcher, receiver = (self._holds_hammer(tool) for tool in self._tools.values())
        up = self._hammer.position[..., 2] > LIFTED_M
        taken = up & receiver & ~fetcher & (self._stage == _HELD_BY_BOTH)
        self._stage[...] = np.where(
            taken | (self._stage == _HANDED_OVER),
            _HANDED_OVER,
            np.where(up & fetcher & receiver, _HELD_BY_BOTH, self._stage * (fetcher | receiver)),
        )

    def to_do(self, arm: str, done: Container[str]) -> str:
        """Return what this arm's operator is to do now; also from what no subtask tells: who holds the hammer, how."""
        if "hammer_handed_over" in done:
            return super().to_do(arm, done)
        fetcher, receiver = self._tools.values()
        held = bool(self._holds_hammer(fetcher))
        if held and bool(self._holds_hammer(receiver)):
            return _BOTH_HOLD[arm]
        along_m = float(self._hammer.frame(fetcher.position)[0])
        if arm == "arm0" and "hammer_fetched" in done and held and along_m > _TOO_FAR_M:
            return "Lay the hammer down and grip it closer to its head: your partner needs the free end of the handle."
        return super().to_do(arm, done)

    def task_status(self) -> TaskStatus:
        handed_over = self._stage == _HANDED_OVER
        cleared = _inside(self._trash, self._trash_tray, TRASH_TRAY_HALF_M)
        placed = _inside(self._hammer, self._bin, BIN_HALF_M) & handed_over
        away_m = length(self._container.frame(self._lid.position)[..., :2])
        subtasks = {
            "lid_removed": (away_m > _LID_AWAY_M) & (self._lid.position[..., 2] < _INSIDE_Z_M),
            "trash_cleared": cleared,
            "hammer_fetched": ~_inside(self._hammer, self._container, _CONTAINER_HALF_M),
            "hammer_handed_over": handed_over,
            "hammer_placed": placed,
        }
        let_go = [self._let_go(tool) for tool in self._tools.values()]
        return TaskStatus(subtasks, all_of([placed, cleared, *let_go]), self._failures())

    def _holds_hammer(self, tool: Tool) -> Flags:
        narrow, wide = _GRIP_WIDTH_M
        at = within(self._hammer.frame(tool.position), _GRIP_M)
        width_m = tool.width_m
        return at & (width_m > narrow) & (width_m < wide)

    def _let_go(self, tool: Tool) -> Flags:
        away_m = length(tool.position - self._hammer.position)
        return (tool.width_m > _RELEASED_WIDTH_M) | (away_m > _RELEASED_M)

    def _failures(self) -> dict[str, Flags]:
        fallen_m = SHELF_Z_M - 0.02
        return {
            "The hammer fell off the shelf.": self._hammer.position[..., 2] < fallen_m,
            "The trash fell off the shelf.": self._trash.position[..., 2] < fallen_m,
        }


SCENE = PickPlaceHandover


def _inside(thing: Thing, box: Thing, half_m: tuple[float, float]) -> Flags:
    return within(box.frame(thing.position)[..., :2], half_m) & (thing.position[..., 2] < _INSIDE_Z_M)


def _add_open_box(spec: mujoco.MjSpec, name: str, half_m: tuple[float, float], **look: object) -> None:
    """Add four walls that nothing moves. The box's frame is at the middle of its floor."""
    box = spec.worldbody.add_body(name=name, mocap=True)
    (half_x, half_y), wall, half_z = half_m, _WALL_HALF_M, _WALL_HEIGHT_M / 2
    for x, y, size_x, size_y in (
        (0, -half_y - wall, half_x + 2 * wall, wall),
        (-half_x - wall, 0, wall, half_y),
        (half_x + wall, 0, wall, half_y),
        (0, half_y + wall, half_x + 2 * wall, wall),
    ):
        box.add_geom(type=_BOX, size=(size_x, size_y, half_z), pos=(x, y, half_z), **_FIRM, **look)


def _add_lid(spec: mujoco.MjSpec) -> mujoco.MjsBody:
    """Add the lid. Its plate meets arms only: it rests on balls, which cost eight contacts instead of thirty."""
    lid = spec.worldbody.add_body(name="lid", pos=(*CONTAINER, _LID_Z_M))
    lid.add_freejoint(name="lid")
    arms = sum(2 << index for index in range(MAX_ARMS))
    lid.add_geom(type=_BOX, size=_LID_HALF_M, mass=0.10, material="oak", contype=0, conaffinity=arms, **_FIRM)
    lid.add_geom(
        name="lid_knob",
        type=_BOX,
        size=KNOB_HALF_M,
        pos=(0, 0, KNOB_Z_M),
        mass=0.04,
        material="walnut",
        **GRASPABLE,
    )
    half_x, half_y = _CONTAINER_HALF_M
    rim = (half_x + _WALL_HALF_M, half_y + _WALL_HALF_M, -_LID_HALF_M[2])
    inset = _CORNER_RADIUS_M + _CORNER_PLAY_M
    corner = (half_x - inset, half_y - inset, -_LID_HALF_M[2] - _CORNER_RADIUS_M)
    for radius, (x, y, z) in ((_RIM_RADIUS_M, rim), (_CORNER_RADIUS_M, corner)):
        for sign_x, sign_y in product((-1, 1), repeat=2):
            place = (sign_x * x, sign_y * y, z)
            lid.add_geom(type=_SPHERE, size=(radius, 0, 0), pos=place, mass=0.0, group=3, **_FIRM)
    add_shadow(spec, "lid", radius_m=0.22)
    return lid


def _add_hammer(spec: mujoco.MjSpec) -> None:
    hammer = spec.worldbody.add_body(name="hammer", pos=(*CONTAINER, SHELF_Z_M + _HEAD_HALF_M[2]))
    hammer.add_freejoint(name="hammer")
    hammer.add_geom(
        name="hammer_handle", type=_BOX, size=HANDLE_HALF_M, mass=0.05, material="walnut", **GRASPABLE
    )
    hammer.add_geom(type=_BOX, size=_HEAD_HALF_M, pos=(_HEAD_X_M, 0, 0), mass=0.10, material="steel", **_FIRM)
    add_shadow(spec, "hammer", radius_m=0.12)
