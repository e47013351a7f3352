from __future__ import annotations

import asyncio
import json
from pathlib import Path

import pytest

from mart.platform.inspect import doctor
from mart.platform.inspect.doctor import Diagnosis, examine
from mart.platform.run.folder_claim import ClaimHolder, claimed
from mart.runtime.ice_servers import IceSettings
from mart.runtime.ports import free_port
from tests.support.processes import running_router, running_service
from tests.support.turn_server import turn_server


def test_without_a_router_it_says_how_to_start_one_and_looks_no_further(tmp_path: Path) -> None:
    findings = list(examine(IceSettings(router=f"tcp/127.0.0.1:{free_port()}", data_dir=tmp_path)))
    assert findings[-1].layer == "router"
    assert not findings[-1].ok
    assert "make run" in findings[-1].mend


@pytest.mark.system
def test_each_service_is_named_with_its_mend(tmp_path: Path) -> None:
    with (
        running_router() as endpoint,
        running_service(["sim", "--room", "room-1"], endpoint, tmp_path, kind="sim", id="room-1"),
    ):
        findings = {
            finding.layer: finding for finding in examine(IceSettings(router=endpoint, data_dir=tmp_path))
        }
    assert findings["router"].ok
    assert findings["sim"].found == "room-1"
    assert not findings["recorder"].ok
    assert "mart recorder" in findings["recorder"].mend
    assert "two_arm_multi_cube_lifting" in findings["room room-1"].found
    assert findings["trainer"].ok
    assert "train" in findings["trainer"].found


@pytest.mark.system
def test_graphics_are_tried_and_the_renderer_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = graphics(tmp_path)
    assert found.ok
    assert len(found.found) > len("on the graphics card")
    for device in ("7", "abc"):
        monkeypatch.setenv("MUJOCO_EGL_DEVICE_ID", device)
        found = graphics(tmp_path)
        assert not found.ok
        assert device in found.found
        assert "MUJOCO_EGL_DEVICE_ID" in found.mend


def test_what_a_killed_platform_left_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    holder = ClaimHolder(7, str(tmp_path), "a", "https://localhost:8443/")
    with claimed(tmp_path / "run", holder):
        assert "process 7 at https://localhost:8443/" in layer(tmp_path, "platform").found
    monkeypatch.setattr(doctor, "leftovers_of", lambda _: holder)
    left = layer(tmp_path, "platform")
    assert not left.ok
    assert "mart stop" in left.mend


def test_a_relay_is_asked_with_its_credentials(tmp_path: Path) -> None:
    async def asked() -> None:
        async with turn_server("mart", "north") as (_, port):
            for credential, ok in (("north", True), ("south", False)):
                entry = {"urls": f"turn:127.0.0.1:{port}", "username": "mart", "credential": credential}
                found = await asyncio.to_thread(layer, tmp_path, "TURN", json.dumps([entry]))
                assert found.ok is ok

    asyncio.run(asked())


def graphics(tmp_path: Path) -> Diagnosis:
    return next(examine(IceSettings(data_dir=tmp_path)))


def layer(tmp_path: Path, name: str, ice_servers: str = "[]") -> Diagnosis:
    settings = IceSettings(router=f"tcp/127.0.0.1:{free_port()}", data_dir=tmp_path, ice_servers=ice_servers)
    with pytest.MonkeyPatch.context() as quick:  # the graphics are another test's
        quick.setattr(doctor, "_graphics", lambda: Diagnosis("graphics", True, ""))
        return next(found for found in examine(settings) if found.layer == name)
