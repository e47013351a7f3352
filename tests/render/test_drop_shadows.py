"""A drop shadow lies on whatever wide thing is below what casts it; states know nothing of that."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mart.render.drop_shadows import DropShadows
from mart.sim.world import World

SPOT_M = 0.0008  # above what it lies on
SHELF_M, LID_M = 0.06, 0.117
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


def spots_m(
    model: mujoco.MjModel, state: bytes, moved: dict[str, tuple[float, float]] | None = None
) -> dict[str, float]:
    """How high each spot is drawn, by what casts it; `moved`: where else a spot is, x and y in the world."""
    data = mujoco.MjData(model)
    mujoco.mj_setState(model, data, np.frombuffer(state, "<f8").astype(np.float64), _STATE)
    for caster, place in (moved or {}).items():
        data.mocap_pos[model.body_mocapid[model.body(f"{caster}/shadow").id], :2] = place
    mujoco.mj_kinematics(model, data)
    DropShadows(model).lift(data)
    bodies = [model.body(number) for number in range(model.nbody)]
    spots = [body for body in bodies if body.name.endswith("/shadow")]
    return {body.name.removesuffix("/shadow"): float(data.geom_xpos[body.geomadr[0], 2]) for body in spots}


@pytest.fixture(scope="module")
def handover() -> World:
    world = World.build("two_arm_pick_place_handover")
    world.reset(3)
    return world


def test_on_the_shelves_every_spot_is_seen(handover: World) -> None:
    heights = spots_m(handover.model, handover.integration_state())
    assert heights == pytest.approx(dict.fromkeys(heights, SHELF_M + SPOT_M))
    assert {"arm0", "arm1", "lid", "hammer"} <= heights.keys()


def test_a_tool_above_the_lid_or_beside_the_shelves_casts_its_spot_there(handover: World) -> None:
    moved = {"arm0": (-0.27, 0.20), "arm1": (0.0, 0.0)}
    heights = spots_m(handover.model, handover.integration_state(), moved)
    assert heights["arm0"] == pytest.approx(LID_M + SPOT_M, abs=0.002)
    assert heights["arm1"] == pytest.approx(SPOT_M)
    assert heights["lid"] == pytest.approx(SHELF_M + SPOT_M)  # not on itself


def test_on_the_bare_table_spots_stay_where_the_state_has_them() -> None:
    world = World.build("two_arm_multi_cube_lifting")
    world.reset(3)
    heights = spots_m(world.model, world.integration_state())
    assert heights == pytest.approx(dict.fromkeys(heights, SPOT_M))


@pytest.mark.parametrize("task", ["two_arm_drink_tray_lifting", "two_arm_pick_place_handover"])
def test_a_plumb_line_goes_from_every_tool_down_to_its_spot(task: str) -> None:
    world = World.build(task)
    world.reset(3)
    model, data = world.model, world.data
    scene, shadows = mujoco.MjvScene(model, maxgeom=10), DropShadows(model)
    world.integration_state()  # puts the spots under the tools
    mujoco.mj_kinematics(model, data)
    shadows.lift(data)
    shadows.add_plumb_lines(scene, data)
    lines = [scene.geoms[number] for number in range(scene.ngeom)]
    assert len(lines) == len(world.arms)
    for line, arm in zip(lines, world.arms, strict=True):
        tool, spot = data.site(f"{arm}/tool").xpos, data.geom_xpos[model.body(f"{arm}/shadow").geomadr[0]]
        ends = line.pos[2] + np.array([-1, 1]) * line.size[2]
        assert ends == pytest.approx([spot[2], tool[2]], abs=1e-5)
        assert line.pos[:2] == pytest.approx(tool[:2], abs=1e-5)


def test_a_tool_that_is_at_its_spot_has_no_line(handover: World) -> None:
    data = handover.data
    scene, shadows = mujoco.MjvScene(handover.model, maxgeom=10), DropShadows(handover.model)
    for arm in handover.arms:
        spot = handover.model.body(f"{arm}/shadow").geomadr[0]
        data.geom_xpos[spot] = data.site(f"{arm}/tool").xpos
    shadows.add_plumb_lines(scene, data)
    assert scene.ngeom == 0
