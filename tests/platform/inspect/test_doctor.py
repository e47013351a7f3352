from __future__ import annotations

from pathlib import Path

import pytest

from mart.platform.inspect.doctor import examine
from mart.runtime.ports import free_port
from mart.runtime.settings import Settings
from tests.support.processes import running_router, running_service


def test_without_a_router_it_says_how_to_start_one_and_looks_no_further(tmp_path: Path) -> None:
    findings = list(examine(Settings(router=f"tcp/127.0.0.1:{free_port()}", data_dir=tmp_path)))
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
            finding.layer: finding for finding in examine(Settings(router=endpoint, data_dir=tmp_path))
        }
    assert findings["router"].ok
    assert findings["sim"].found == "room-1"
    assert not findings["recorder"].ok
    assert "mart recorder" in findings["recorder"].mend
    assert "two_arm_multi_cube_lifting" in findings["room room-1"].found
