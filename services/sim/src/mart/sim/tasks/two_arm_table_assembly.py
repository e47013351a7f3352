"""Build table assembly: a base with two sockets, a column for each, and a tabletop with a knob at either end.

Everything goes together by its shape. The knobs are round, so that a tabletop held by one of them hangs down: it takes
two arms to carry it level (bars instead of knobs would let one arm do it).
"""

from __future__ import annotations

from itertools import product

import mujoco
import numpy as np

from mart.protocol.tasks import Arm
from mart.sim.scene.data import Array, Data, Flags, length, within
from mart.sim.scene.palette import rgba
from mart.sim.scene.scene import Scene, TaskStatus, all_of
from mart.sim.scene.scenery import TABLE_HALF_M
from mart.sim.scene.shadows import add_shadow
from mart.sim.scene.symbols import add_tile
from mart.sim.scene.things import Thing, Tool

BASE_HALF_M = (0.18, 0.06, 0.005)
SOCKET_X_M = 0.12  # of the sockets in the base, of the columns and of the tabletop's holes
_SOCKET_HALF_M, _WALL_HALF_M, _WALL_HEIGHT_M = 0.038, 0.007, 0.025
SEAT_Z_M = 2 * BASE_HALF_M[2]  # where a seated column's foot stands, in the base

_SHAFT_HALF_M, COLUMN_HEIGHT_M = 0.011, 0.14
# A foot so broad and heavy that a column stays up when it is pushed or set down hastily. Under it four balls instead of
# edges: four contacts, and a chamfer that finds the socket.
_FOOT_HALF_M, _FOOT_HEIGHT_M, _BALL_RADIUS_M = 0.034, 0.018, 0.009
# It is gripped by a round neck, from which it hangs straight down: one that lies on the table rises when it is lifted.
_NECK_Z_M, _NECK_RADIUS_M = 0.117, 0.022
_SHOULDER_RADIUS_M, _SHOULDER_HEIGHT_M = 0.019, 0.0025
_PEG_RADIUS_M, _PEG_HEIGHT_M = 0.010, 0.015  # the palm is 45 mm above the pads, so no peg may be higher

TOP_HALF_M = (0.17, 0.10, 0.01)
_HOLE_HALF_M = 0.016
KNOB_X_M = 0.205
_KNOB_RADIUS_M, _KNOB_HALF_M = 0.015, 0.006
TOP_SEATED_Z_M = SEAT_Z_M + COLUMN_HEIGHT_M + TOP_HALF_M[2]  # of its middle, in the base
# Two blocks high enough that the tabletop need not be lifted far, and falls softly.
_REST_HEIGHT_M, _REST_Y_M = 0.12, 0.30
LIFTED_M, _LEVEL = (
    _REST_HEIGHT_M + 0.04,
    0.98,
)  # one arm that lifts an end raises the middle by 2 cm until it leans so

# kg/m³: columns of 0.18 kg and a tabletop of 0.42 kg, under which no arm sags by more than 5 mm.
_DENSITY = {"column": 340.0, "foot": 3200.0, "tabletop": 310.0}
_FIRM = {"solref": (0.004, 1.0)}
_SLIPPERY_SOCKET = {"priority": 1, "friction": (0.3, 0.005, 0.0001), **_FIRM}
_SLIPPERY_FOOT = {"priority": 1, "friction": (0.15, 0.005, 0.0001), **_FIRM}  # slides where it is pushed
_SLIPPERY_PEG = {"priority": 1, "friction": (0.2, 0.005, 0.0001), **_FIRM}
# A pivot, in which a column swings once or twice before it hangs still.
_PIVOT = {"priority": 1, "condim": 4, "friction": (1.0, 0.0003, 0.0001), **_FIRM}
_UNSEEN = {"group": 3}
_GHOST = {"contype": 0, "conaffinity": 0, "mass": 0.0}
_BOX, _SPHERE, _CYLINDER, _CAPSULE = (
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_SPHERE,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
    mujoco.mjtGeom.mjGEOM_CAPSULE,
)

_RELEASED_WIDTH_M, _RELEASED_M = 0.06, 0.27


class TableAssembly(Scene):
    """Define the scene of table assembly."""

    def add_objects(self, spec: mujoco.MjSpec) -> None:
        self._add_base(spec)
        for arm, side in zip(self.task.arms, (-1, 1), strict=True):
            _add_column(spec, arm, side)
        self._add_tabletop(spec)

    def _add_base(self, spec: mujoco.MjSpec) -> None:
        base = spec.worldbody.add_body(name="table_base", mocap=True)
        base.add_geom(
            type=_BOX, size=BASE_HALF_M, pos=(0, 0, BASE_HALF_M[2]), material="walnut", **_SLIPPERY_SOCKET
        )
        out, half_z = _SOCKET_HALF_M + _WALL_HALF_M, _WALL_HEIGHT_M / 2
        for arm, side in zip(self.task.arms, (-1, 1), strict=True):
            for x, y, half_x, half_y in (
                (0, -out, out + _WALL_HALF_M, _WALL_HALF_M),
                (-out, 0, _WALL_HALF_M, _SOCKET_HALF_M),
                (out, 0, _WALL_HALF_M, _SOCKET_HALF_M),
                (0, out, out + _WALL_HALF_M, _WALL_HALF_M),
            ):
                base.add_geom(
                    type=_BOX,
                    size=(half_x, half_y, half_z),
                    pos=(SOCKET_X_M * side + x, y, SEAT_Z_M + half_z),
                    material="paint",
                    rgba=rgba(arm.color),
                    **_SLIPPERY_SOCKET,
                )

    def _add_tabletop(self, spec: mujoco.MjSpec) -> None:
        for x in (-0.08, 0.08):
            spec.worldbody.add_geom(
                type=_BOX,
                size=(0.012, TOP_HALF_M[1], _REST_HEIGHT_M / 2),
                pos=(x, _REST_Y_M, _REST_HEIGHT_M / 2),
                material="slate",
            )
        top = spec.worldbody.add_body(name="tabletop", pos=(0, _REST_Y_M, _REST_HEIGHT_M + TOP_HALF_M[2]))
        top.add_freejoint(name="tabletop")
        half_x, half_y, half_z = TOP_HALF_M
        hole, beside = _HOLE_HALF_M, (half_y - _HOLE_HALF_M) / 2
        end = (half_x - SOCKET_X_M - hole) / 2
        for x, y, size_x, size_y in (
            (0, -hole - beside, half_x, beside),
            (-half_x + end, 0, end, hole),
            (0, 0, SOCKET_X_M - hole, hole),
            (half_x - end, 0, end, hole),
            (0, hole + beside, half_x, beside),
        ):
            size = (size_x, size_y, half_z)
            top.add_geom(
                type=_BOX, size=size, pos=(x, y, 0), material="oak", density=_DENSITY["tabletop"], **_FIRM
            )
        for arm, side in zip(self.task.arms, (-1, 1), strict=True):
            _add_knob(spec, top, arm, side)
        add_shadow(spec, "tabletop", radius_m=0.26)

    def attach(self, data: Data) -> None:
        self._base, self._top = Thing(data, "table_base"), Thing(data, "tabletop")
        self._columns = [Thing(data, column_of(arm)) for arm in self.task.arm_names]
        self._tools = {arm.name: Tool(data, arm) for arm in self.task.arms}

    def place_objects(self, random: np.random.Generator) -> None:
        x, y = random.uniform(-0.02, 0.02, 2)
        self._base.put((x, y - 0.02, 0.0), random.uniform(-0.1, 0.1))
        for column, side in zip(self._columns, (-1, 1), strict=True):
            x, y = random.uniform(-0.03, 0.03, 2)
            column.put((0.20 * side + x, y - 0.25, 0.0), random.uniform(-0.3, 0.3))
        x, y = random.uniform(-0.02, 0.02, 2)
        self._top.put((x, _REST_Y_M + y, _REST_HEIGHT_M + TOP_HALF_M[2]), random.uniform(-0.1, 0.1))

    def observe(self) -> dict[str, Array]:
        observations = {f"{arm}/tool_position_in_world": tool.position for arm, tool in self._tools.items()}
        for thing in (self._base, self._top, *self._columns):
            observations |= thing.observations()
        return observations

    def task_status(self) -> TaskStatus:
        column0, column1 = (
            self._column_seated(*of_one) for of_one in zip(self._columns, (-1, 1), strict=True)
        )
        up = (self._top.position[..., 2] > LIFTED_M) & (self._top.uprightness > _LEVEL)
        seated = self._top_seated() & column0 & column1
        subtasks = {
            "column0_seated": column0,
            "column1_seated": column1,
            "tabletop_lifted": up | seated,
            "tabletop_seated": seated,
        }
        let_go = [self._let_go(tool) for tool in self._tools.values()]
        return TaskStatus(subtasks, all_of([seated, *let_go]), self._failures())

    def _column_seated(self, column: Thing, side: int) -> Flags:
        off = self._base.frame(column.position) - (SOCKET_X_M * side, 0.0, SEAT_Z_M)
        return within(off, (0.020, 0.020, 0.006)) & (column.uprightness > 0.985)

    def _top_seated(self) -> Flags:
        off = self._base.frame(self._top.position) - (0.0, 0.0, TOP_SEATED_Z_M)
        return within(off, (0.015, 0.015, 0.006)) & (self._top.uprightness > 0.995)

    def _let_go(self, tool: Tool) -> Flags:
        away_m = length(tool.position - self._top.position)
        return (tool.width_m > _RELEASED_WIDTH_M) | (away_m > _RELEASED_M)

    def _failures(self) -> dict[str, Flags]:
        failures = {}
        for index, column in enumerate(self._columns):
            failures[f"Column {index} fell off the table."] = _off_the_table(column)
        failures["The tabletop fell off the table."] = _off_the_table(self._top)
        failures["The tabletop tipped over."] = self._top.uprightness < 0.5
        return failures


SCENE = TableAssembly


def column_of(arm: str) -> str:
    """Return the name of an arm's column."""
    return arm.replace("arm", "column")


def _add_column(spec: mujoco.MjSpec, arm: Arm, side: int) -> None:
    """Add the arm's column, whose frame is at its foot."""
    name = column_of(arm.name)
    half, height, foot, radius = _SHAFT_HALF_M, COLUMN_HEIGHT_M, _FOOT_HALF_M, _BALL_RADIUS_M
    column = spec.worldbody.add_body(name=name, pos=(0.20 * side, -0.25, 0))
    column.add_freejoint(name=name)
    look = {"material": "paint", "rgba": rgba(arm.color)}
    for part, size, bottom, top in (
        ("foot", foot, radius, _FOOT_HEIGHT_M),
        ("column", half, _FOOT_HEIGHT_M, _NECK_Z_M),
    ):
        column.add_geom(
            type=_BOX,
            size=(size, size, (top - bottom) / 2),
            pos=(0, 0, (bottom + top) / 2),
            density=_DENSITY[part],
            **look,
            **_FIRM,
        )
    column.add_geom(
        type=_CYLINDER,
        size=(_SHOULDER_RADIUS_M, _SHOULDER_HEIGHT_M / 2, 0),
        pos=(0, 0, height - _SHOULDER_HEIGHT_M / 2),
        density=_DENSITY["column"],
        **look,
        **_FIRM,
    )
    column.add_geom(
        type=_SPHERE,
        size=(_NECK_RADIUS_M, 0, 0),
        pos=(0, 0, _NECK_Z_M),
        density=_DENSITY["column"],
        **look,
        **_PIVOT,
    )
    inset = foot - radius
    for x, y in product((-inset, inset), repeat=2):
        column.add_geom(
            type=_SPHERE, size=(radius, 0, 0), pos=(x, y, radius), mass=0, **_SLIPPERY_FOOT, **_UNSEEN
        )
    column.add_geom(type=_BOX, size=(foot, foot, radius / 2), pos=(0, 0, radius / 2), **look, **_GHOST)
    column.add_geom(
        type=_CAPSULE,
        size=(_PEG_RADIUS_M, 0, 0),
        fromto=(0, 0, height - _PEG_RADIUS_M, 0, 0, height + _PEG_HEIGHT_M - _PEG_RADIUS_M),
        mass=0.004,
        material="brass",
        **_SLIPPERY_PEG,
    )
    for normal in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
        position = (half * normal[0], half * normal[1], 0.5 * height)
        add_tile(spec, column, arm.symbol, radius_m=0.008, position=position, normal=normal)
    add_shadow(spec, name, radius_m=0.055)


def _add_knob(spec: mujoco.MjSpec, top: mujoco.MjsBody, arm: Arm, side: int) -> None:
    post = (KNOB_X_M - TOP_HALF_M[0]) / 2
    look = {"material": "paint", "rgba": rgba(arm.color), "density": _DENSITY["tabletop"], **_FIRM}
    top.add_geom(type=_BOX, size=(post, 0.004, 0.005), pos=(side * (KNOB_X_M - post), 0, 0), **look)
    x, y = side * KNOB_X_M, _KNOB_HALF_M
    top.add_geom(
        name=f"knob{side}", type=_CAPSULE, size=(_KNOB_RADIUS_M, 0, 0), fromto=(x, -y, 0, x, y, 0), **look
    )
    tile = (side * (SOCKET_X_M + 0.033), 0.0, TOP_HALF_M[2])
    add_tile(spec, top, arm.symbol, radius_m=0.010, position=tile, normal=(0, 0, 1))


def _off_the_table(thing: Thing) -> Flags:
    return ~within(thing.position[..., :2], TABLE_HALF_M) | (thing.position[..., 2] < -0.05)
