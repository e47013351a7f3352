from __future__ import annotations

from importlib.machinery import ModuleSpec
from pathlib import Path

import pytest

from mart.protocol.errors import Unavailable
from mart.sim.scene import meshes
from mart.sim.scene.meshes import mesh_path
from mart.sim.world import World


def test_meshes_are_found_without_importing_the_package() -> None:
    assert mesh_path("link7", "hull").is_file()
    assert mesh_path("link7", "detailed").stat().st_size > mesh_path("link7", "hull").stat().st_size


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshes, "find_spec", lambda name: None)
    with pytest.raises(Unavailable, match="pip install gymnasium-robotics"):
        mesh_path("link0", "hull")


def test_a_package_without_meshes_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    elsewhere = ModuleSpec("gymnasium_robotics", None, origin=str(tmp_path / "__init__.py"))
    monkeypatch.setattr(meshes, "find_spec", lambda name: elsewhere)
    with pytest.raises(Unavailable, match=r"constraints\.txt"):
        mesh_path("link0", "hull")


def test_detail_changes_looks_only() -> None:
    plain, detailed = (
        World.build("two_arm_multi_cube_lifting", detail=detail) for detail in ("hull", "detailed")
    )
    assert detailed.model.nmeshface > 20 * plain.model.nmeshface
    states = []
    for world in (plain, detailed):
        world.reset(0)
        for _ in range(5):
            world.step([[0.5, 0, -1, 0, 0, 0.3, 1]] * 2)
        states.append(world.integration_state())
    assert states[0] == states[1]
