"""A scene holds all that is drawn of a task, and says in words what pages cannot draw."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import get_task, task_names
from mart.render.scene_export import export_scene
from mart.sim.world import World
from tests.render.scene_reading import read_scene

MOST_BYTES = 1_600_000


def seen_geoms(model: mujoco.MjModel) -> int:
    """How many geoms MuJoCo draws."""
    data, scene = mujoco.MjData(model), mujoco.MjvScene(model, maxgeom=2000)
    mujoco.mj_kinematics(model, data)
    everything = mujoco.mjtCatBit.mjCAT_ALL
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, mujoco.MjvCamera(), everything, scene)
    return int(scene.ngeom)


@pytest.mark.parametrize("task", task_names())
def test_a_task_is_whole_in_its_scene(task: str) -> None:
    model = World.build(task).model
    exported = export_scene(model)
    assert len(exported.data) < MOST_BYTES
    scene = read_scene(exported.data)
    described = scene.description
    assert len(described["geoms"]) == seen_geoms(model)
    assert [camera["name"] for camera in described["cameras"]] == [
        model.camera(camera).name for camera in range(model.ncam)
    ]
    lines = [line["geom"] for line in described["plumb_lines"]]
    assert len(lines) == len(get_task(task).arms)
    assert {geom["mesh"] for geom in [*described["geoms"], *lines]} == set(range(len(described["meshes"])))
    for mesh in range(len(described["meshes"])):
        positions, normals, triangles = scene.mesh(mesh)
        assert triangles.max() == len(positions) - 1
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=0.02)
    assert {geom["body"] for geom in described["geoms"]} == set(range(-1, len(described["bodies"])))


def test_a_plumb_line_hangs_from_the_tool_to_its_spot() -> None:
    world = World.build("two_arm_multi_cube_lifting")
    described = read_scene(export_scene(world.model).data).description
    line = described["plumb_lines"][1]
    assert (described["bodies"][line["body"]], described["bodies"][line["foot_body"]]) == (
        "arm1/hand",
        "arm1/shadow",
    )
    np.testing.assert_allclose(line["position_m"], world.model.site("arm1/tool").pos, atol=1e-6)


def test_the_ghosts_of_a_task_say_whose_step_they_are() -> None:
    task = get_task("two_arm_pick_place_handover")
    model = World.build(task.name).model
    (ghost,) = read_scene(export_scene(model, task).data).description["ghosts"]
    assert ghost["subtask"] == "hammer_handed_over"
    assert ghost["after"]["arm0"] == ["lid_removed", "hammer_fetched"]
    assert len(ghost["geoms"]) == 4  # handle, head, plumb line and its foot
    assert read_scene(export_scene(model).data).description["ghosts"] == []


def test_a_model_has_one_scene_and_another_model_another() -> None:
    model = World.build("two_arm_multi_cube_lifting").model
    assert export_scene(model) == export_scene(model)
    model.geom_rgba[-1] = (0.1, 0.2, 0.3, 1)
    changed = export_scene(model)
    model.geom_rgba[-1] = (0.3, 0.2, 0.1, 1)
    assert export_scene(model).sha256 != changed.sha256


def test_a_mesh_is_where_the_model_has_it() -> None:
    model = World.build("two_arm_multi_cube_lifting").model
    scene = read_scene(export_scene(model).data)
    corners = {
        tuple(np.ptp(scene.mesh(mesh)[0], axis=0).round(4))
        for mesh in range(len(scene.description["meshes"]))
    }
    for mesh in range(model.nmesh):
        first = model.mesh_vertadr[mesh]
        vertices = model.mesh_vert[first : first + model.mesh_vertnum[mesh]]
        assert tuple(np.ptp(vertices, axis=0).astype(float).round(4)) in corners


def test_textures_come_back_pixel_by_pixel() -> None:
    model = World.build("two_arm_multi_cube_lifting").model
    scene = read_scene(export_scene(model).data)
    kept = [
        model.tex_data[at : at + height * width * channels].reshape(height, width, channels)
        for at, height, width, channels in zip(
            model.tex_adr, model.tex_height, model.tex_width, model.tex_nchannel, strict=True
        )
    ]
    for texture in range(len(scene.description["textures"])):
        pixels = scene.texture(texture)
        assert any(one.shape == pixels.shape and (one == pixels).all() for one in kept)


@pytest.mark.parametrize(
    ("body", "why"),
    [
        ("<geom type='plane' size='0 0 1'/>", "kind"),
        ("<light type='spot'/><geom size='.1'/>", "lights"),
        ("<geom size='.1'/><body><joint/><geom size='.1'/><camera name='on'/></body>", "camera"),
        ("<geom size='.1'/><site size='.1'/>", "no geom"),
    ],
)
def test_what_pages_cannot_draw_is_refused_in_words(body: str, why: str) -> None:
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    with pytest.raises(InvalidInput, match=why):
        export_scene(model)
