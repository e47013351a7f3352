"""Somebody's MJCF: all files that it names are read here, bounded, and none from outside its folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.protocol.errors import InvalidInput, MartError, NotFound
from mart.sim.scene import mjcf_files
from mart.sim.scene.mjcf_files import read_scene

TETRAHEDRON = "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def scene(folder: Path, inside: str, compiler: str = "") -> Path:
    path = folder / "scene.xml"
    path.write_text(f"<mujoco>{compiler}{inside}</mujoco>")
    return path


def mesh(name: str) -> str:
    body = '<worldbody><geom type="mesh" mesh="m"/></worldbody>'
    return f'<asset><mesh name="m" file="{name}"/></asset>{body}'


def test_meshes_and_included_files_are_taken_from_below_its_folder(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "m.obj").write_text(TETRAHEDRON)
    (tmp_path / "more.xml").write_text(
        '<mujoco><worldbody><body name="b"><geom size="1"/></body></worldbody></mujoco>'
    )
    path = scene(tmp_path, '<include file="more.xml"/>' + mesh("m.obj"), '<compiler meshdir="parts"/>')
    model = read_scene(path).spec.compile()
    assert (model.nmesh, model.body(1).name) == (1, "b")
    (tmp_path / "parts" / "m.obj").unlink()
    with pytest.raises(NotFound, match=r"m\.obj.*<mesh>"):
        read_scene(path)


@pytest.mark.parametrize("outside", ["../secret.obj", "/etc/passwd", "a/../../secret.obj", "link.obj"])
def test_nothing_is_read_from_outside_its_folder(tmp_path: Path, outside: str) -> None:
    folder = tmp_path / "task"
    folder.mkdir()
    (tmp_path / "secret.obj").write_text(TETRAHEDRON)
    (folder / "link.obj").symlink_to(tmp_path / "secret.obj")
    for inside in (mesh(outside), f'<include file="{outside}"/>'):
        with pytest.raises(InvalidInput, match="outside its own folder"):
            read_scene(scene(folder, inside))
    with pytest.raises(InvalidInput, match="below the file's own"):
        read_scene(scene(folder, mesh("secret.obj"), '<compiler meshdir=".."/>'))


@pytest.mark.parametrize(
    "inside",
    [
        '<!DOCTYPE x [<!ENTITY a "b">]><mujoco/>',
        '<mujoco><extension><plugin plugin="mujoco.elasticity.cable"/></extension></mujoco>',
        '<mujoco><asset><model name="m" file="m.xml"/></asset></mujoco>',
        '<mujoco><include file="scene.xml"/></mujoco>',
        "<mujoco><nothing/></mujoco>",
        "<mujoco>",
        "",
    ],
)
def test_what_is_not_taken_is_a_sentence(tmp_path: Path, inside: str) -> None:
    path = tmp_path / "scene.xml"
    path.write_text(inside)
    with pytest.raises(MartError) as refused:
        read_scene(path)
    assert str(path) in str(refused.value)
    assert str(refused.value).endswith(".")


def test_sizes_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "m.obj").write_text(TETRAHEDRON)
    path = scene(tmp_path, mesh("m.obj"))
    monkeypatch.setattr(mjcf_files, "MAX_ASSET_BYTES", 10)
    with pytest.raises(InvalidInput, match="coarser"):
        read_scene(path)
    monkeypatch.setattr(mjcf_files, "MAX_XML_BYTES", 10)
    with pytest.raises(InvalidInput, match="bytes"):
        read_scene(path)


def test_a_missing_scene_is_named(tmp_path: Path) -> None:
    with pytest.raises(NotFound, match=r"nothing\.xml"):
        read_scene(tmp_path / "nothing.xml")
