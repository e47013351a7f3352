"""Build a wooden tray with two handles in the colours of the arms they belong to, and drinks that stand free on it.

The handles' bars lie across the tray's length, so that fingers straddle them from above. Plain cylinders are the
steadiest drinks: they topple when the tray leans by 26 degrees, which is one handle 21 cm above the other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.protocol.tasks.tray import DRINKS, handle_of
from mart.sim.scene.data import Array, Data, Flags, into_frame
from mart.sim.scene.gripper import GRASPABLE
from mart.sim.scene.palette import rgba
from mart.sim.scene.shadows import add_shadow
from mart.sim.scene.symbols import add_tile

HALF_M = (0.17, 0.13, 0.005)  # of the plate, about the tray's origin
HANDLE_M = (0.235, 0.0, 0.045)  # of the middle of a bar, in the tray's frame, or with -x
_BAR_HALF_M = (0.010, 0.058, 0.010)
_RIM_HALF_M, _RIM_TOP_M = 0.004, 0.019
_PLATE_KG, _RIM_KG, _BAR_KG, _STRUT_KG = 0.23, 0.03, 0.03, 0.01

DRINK_RADIUS_M, DRINK_HALF_M = 0.030, 0.060
_DRINK_KG = 0.25
_DRINKS_AT_M = ((-0.08, -0.055), (-0.08, 0.055), (0.08, -0.055), (0.08, 0.055))
# Where they are put when an episode begins, in the same order: so far from the handles that a hand which grips one has
# a few centimetres to spare. The model keeps the places above, so that recordings so far can be stepped again.
_DRINKS_BEGIN_M = tuple((math.copysign(0.068, x), y) for x, y in _DRINKS_AT_M)
_DRINKS_SPREAD_M = 0.015
_SLIDING = {"friction": (0.6, 0.005, 0.0001)}

_UPRIGHT_MIN = math.cos(math.radians(30.0))  # of a drink's axis, its share of up
_BESIDE_M = (HALF_M[0] + 0.01, HALF_M[1] + 0.01)
_STANDING_MIN_M = 0.03  # of a drink's middle over the plate's

_BOX, _CYLINDER = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER
_LOOKS = {"contype": 0, "conaffinity": 0, "mass": 0}


def add_tray(spec: mujoco.MjSpec, carriers: Sequence[Arm]) -> None:
    """Add tray and drinks; carriers: whose handle is at -x and whose at +x of the tray's frame."""
    # With drinks, the solver needs a quarter fewer iterations like this; a tray held for half a minute creeps 0.3 mm.
    spec.option.impratio, spec.option.tolerance = 50, 1e-9
    tray = spec.worldbody.add_body(name="tray", pos=(0, 0, HALF_M[2]))
    tray.add_freejoint(name="tray")
    tray.add_geom(name="tray", type=_BOX, size=HALF_M, mass=_PLATE_KG, material="oak", **_SLIDING)
    _add_rim(tray)
    for carrier, side in zip(carriers, (-1, 1), strict=True):
        add_handle(spec, tray, carrier, side)
    for index, (x, y) in enumerate(_DRINKS_AT_M):
        _add_drink(spec, index, (x, y, 2 * HALF_M[2] + DRINK_HALF_M))
    add_shadow(spec, "tray", radius_m=0.24)


def _add_rim(tray: mujoco.MjsBody) -> None:
    x, y, bottom = HALF_M
    middle, half = (_RIM_TOP_M + bottom) / 2, (_RIM_TOP_M - bottom) / 2
    for side in (-1, 1):
        for position, size in (
            ((side * (x - _RIM_HALF_M), 0, middle), (_RIM_HALF_M, y, half)),
            ((0, side * (y - _RIM_HALF_M), middle), (x - 2 * _RIM_HALF_M, _RIM_HALF_M, half)),
        ):
            tray.add_geom(type=_BOX, pos=position, size=size, mass=_RIM_KG, material="walnut")


def add_handle(spec: mujoco.MjSpec, tray: mujoco.MjsBody, carrier: Arm, side: int) -> None:
    """Add the carrier's handle at the end of a plate as long as the tray's; side: -1 at -x, 1 at +x."""
    x, y, z = side * HANDLE_M[0], HANDLE_M[1], HANDLE_M[2]
    name, look = handle_of(carrier.name), {"material": "paint", "rgba": rgba(carrier.color)}
    tray.add_site(name=name, pos=(x, y, z), size=(0.005, 0, 0), group=4)
    tray.add_geom(name=name, type=_BOX, pos=(x, y, z), size=_BAR_HALF_M, mass=_BAR_KG, **look, **GRASPABLE)
    for end in (-1, 1):
        at_bar = (x, end * 0.064, z)
        at_rim = (side * (HALF_M[0] - 0.006), end * 0.064, 0.008)
        tray.add_geom(type=_BOX, fromto=(*at_rim, *at_bar), size=(0.006, 0.006, 0), mass=_STRUT_KG, **look)
    add_tile(
        spec, tray, carrier.symbol, radius_m=0.008, position=(x, y, z + _BAR_HALF_M[2]), normal=(0, 0, 1)
    )


def _add_drink(spec: mujoco.MjSpec, index: int, position: tuple[float, float, float]) -> None:
    drink = spec.worldbody.add_body(name=f"drink{index}", pos=position)
    drink.add_freejoint(name=f"drink{index}")
    drink.add_geom(
        name=f"drink{index}",
        type=_CYLINDER,
        size=(DRINK_RADIUS_M, DRINK_HALF_M, 0),
        mass=_DRINK_KG,
        material="ceramic",
        **_SLIDING,
    )
    drink.add_geom(
        type=_CYLINDER,
        size=(DRINK_RADIUS_M - 0.004, 0.0004, 0),
        pos=(0, 0, DRINK_HALF_M),
        material="juice",
        **_LOOKS,
    )


class Tray:
    """View the tray and its drinks in a world's state, or in a batch's: shapes (...) are () or (worlds,)."""

    def __init__(self, data: Data, carriers: Sequence[Arm]) -> None:
        tray, drink = data.body("tray"), data.body("drink0").id
        self.position, self._quaternion = tray.xpos, tray.xquat  # shapes (..., 3) and (..., 4)
        self._rotation = tray.xmat.reshape(*tray.xmat.shape[:-1], 3, 3)
        self._drinks = data.xpos[..., drink : drink + DRINKS, :]
        self._uprightness = data.xmat[..., drink : drink + DRINKS, 8]
        self._joints = [data.joint(name).qpos for name in ("tray", *(f"drink{i}" for i in range(DRINKS)))]
        handles = {handle_of(arm.name): data.site(handle_of(arm.name)) for arm in carriers}
        tools = {f"{arm.name}/tool": data.site(f"{arm.name}/tool") for arm in carriers}
        self._seen = {
            **{f"{handle}/position_in_world": site.xpos for handle, site in handles.items()},
            **{f"{tool}_position_in_world": site.xpos for tool, site in tools.items()},
            "tray/position_in_world": self.position,
            "tray/quaternion_in_world": self._quaternion,
        }

    def place(self, x_m: float, y_m: float, yaw_rad: float, random: np.random.Generator) -> None:
        """Put it on the table of a single world, each drink near its place."""
        tray, *drinks = self._joints
        turn = np.array([math.cos(yaw_rad / 2), 0.0, 0.0, math.sin(yaw_rad / 2)])
        placed = Pose(np.array([x_m, y_m, HALF_M[2]]), turn)
        tray[:] = *placed.position, *turn
        for (x, y), drink in zip(_DRINKS_BEGIN_M, drinks, strict=True):
            beside_x, beside_y = random.uniform(-_DRINKS_SPREAD_M, _DRINKS_SPREAD_M, 2)
            foot = placed.transform_points((x + beside_x, y + beside_y, HALF_M[2] + DRINK_HALF_M))
            drink[:] = *foot, 1.0, 0.0, 0.0, 0.0

    def observe(self) -> dict[str, Array]:
        """Return what is seen of tray, handles, tools and drinks."""
        return {**self._seen, "drinks/positions_in_world": self._drinks.reshape(*self._drinks.shape[:-2], -1)}

    def lowest_point_m(self) -> Array:
        """Return the height of the plate's lowest corner over the table, shape (...)."""
        leaning = np.add.reduce(np.abs(self._rotation[..., 2, :]) * HALF_M, axis=-1)
        return self.position[..., 2] - leaning

    def spills(self) -> dict[str, Flags]:
        """Return what may have become of a drink, in words, and where it has."""
        tipped = self._uprightness < _UPRIGHT_MIN
        from_tray = self._drinks - self.position[..., None, :]
        in_tray = into_frame(self._rotation[..., None, :, :], from_tray)
        beside = np.logical_or.reduce(np.abs(in_tray[..., :2]) > _BESIDE_M, axis=-1)
        return {
            "A drink tipped over.": np.logical_or.reduce(tipped, axis=-1),
            "A drink fell off the tray.": np.logical_or.reduce(
                beside | (in_tray[..., 2] < _STANDING_MIN_M), axis=-1
            ),
        }


def across(pose_tool_in_base: Pose) -> Pose:
    """Return the tool turned by a quarter: the fingers then close along the arm's reach, across a handle's bar."""
    return pose_tool_in_base @ Pose(np.zeros(3), np.array([math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]))
