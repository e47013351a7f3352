"""Lay each drop shadow on the highest wide surface below what casts it: a shelf, a lid or a tray hides the table.

From every tool a plumb line goes down to its spot.

A state puts the spots (bodies named `…/shadow`) on the table. Only pictures lift them, so states and their digests stay
what they were, and recordings of any version show them.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from mart.render.decor import Color, add_column

_SUFFIX = "/shadow"
_WIDE_M = 0.09  # half of a side, at least: what is held in a hand hides no spot
_LEVEL = 0.97  # cosine of the tilt up to which something counts as a surface
_HIDDEN_GROUP = 3
_LINE_RADIUS_M, _LINE_ALPHA, _SHORTEST_M = 0.003, 0.75, 0.01


@dataclass(frozen=True)
class PlumbLine:
    """Say of a line from a tool down to its spot which site is above, which geom is below, and how it looks."""

    site: int
    foot_geom: int
    radius_m: float
    rgba: Color


@dataclass(frozen=True)
class _Spot:
    geom: int
    own_body: int
    body: int  # what casts it
    site: int  # the tool, where an arm casts it, else -1


class DropShadows:
    """Find a model's spots and its wide boxes once, then lift the spots of every state."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model = model
        self._spots = [spot for body in range(model.nbody) if (spot := _spot(model, body)) is not None]
        self._surfaces = [geom for geom in range(model.ngeom) if _is_wide_box(model, geom)]

    def lift(self, data: mujoco.MjData) -> None:
        """Lift the spots in `data`, and their bodies; its kinematics are up to date."""
        for spot in self._spots:
            x, y, _ = data.geom_xpos[spot.geom].tolist()
            height_m = (data.site_xpos[spot.site] if spot.site >= 0 else data.xpos[spot.body])[2]
            tops = (self._top_m(data, geom, spot, x, y) for geom in self._surfaces)
            lift_m = max((top for top in tops if top < height_m), default=0.0)
            data.geom_xpos[spot.geom, 2] += lift_m
            data.xpos[spot.own_body, 2] += lift_m

    def plumb_lines(self) -> list[PlumbLine]:
        """Return the lines from tools down to their spots."""
        return [
            PlumbLine(spot.site, spot.geom, _LINE_RADIUS_M, self._line_rgba(spot))
            for spot in self._spots
            if spot.site >= 0
        ]

    def add_plumb_lines(self, scene: mujoco.MjvScene, data: mujoco.MjData) -> None:
        """Add a line from every tool in `data` down to its spot, which has been lifted: it shows the tool's height."""
        for line in self.plumb_lines():
            x, y, top_m = data.site_xpos[line.site].tolist()
            foot_m = float(data.geom_xpos[line.foot_geom, 2])
            if top_m - foot_m > _SHORTEST_M:
                add_column(scene, (x, y, foot_m), top_m - foot_m, line.radius_m, line.rgba)

    def _line_rgba(self, spot: _Spot) -> Color:
        return np.append(2.0 * self._model.geom_rgba[spot.geom, :3], _LINE_ALPHA).astype(np.float32)

    def _top_m(self, data: mujoco.MjData, geom: int, spot: _Spot, x: float, y: float) -> float:
        """Return how high the box's upper side is under (x, y); 0 where it is not there, or casts the spot itself."""
        half_x, half_y, half_z = self._model.geom_size[geom].tolist()
        center_x, center_y, center_z = data.geom_xpos[geom].tolist()
        xx, xy, _, yx, yy, _, _, _, level = data.geom_xmat[geom].tolist()  # its axes are the columns
        dx, dy = x - center_x, y - center_y
        is_under = abs(dx * xx + dy * yx) < half_x and abs(dx * xy + dy * yy) < half_y
        if not is_under or level < _LEVEL or self._model.geom_bodyid[geom] == spot.body:
            return 0.0
        return float(center_z + half_z)


def _spot(model: mujoco.MjModel, body: int) -> _Spot | None:
    name = model.body(body).name
    if not name.endswith(_SUFFIX):
        return None
    caster = name.removesuffix(_SUFFIX)
    return _Spot(
        int(model.body_geomadr[body]),
        body,
        mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, caster),
        mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, f"{caster}/tool"),
    )


def _is_wide_box(model: mujoco.MjModel, geom: int) -> bool:
    is_seen = model.geom_group[geom] < _HIDDEN_GROUP
    is_box = model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_BOX
    return bool(is_box and is_seen and (model.geom_size[geom, :2] >= _WIDE_M).all())
