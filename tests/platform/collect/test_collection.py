"""What a collection runs on: nothing of a platform in the same folder is touched."""

from __future__ import annotations

from pathlib import Path

from mart.platform.collect import collection
from mart.platform.collect.collection import CollectionSpec
from mart.platform.collect.operators import parse_operators
from mart.platform.run.plan import DEFAULT_TASK, PlatformOptions, lockstep_processes, processes
from mart.protocol.vocabulary import ServiceKind


def test_it_has_rooms_a_run_folder_and_logs_of_its_own(tmp_path: Path) -> None:
    spec = CollectionSpec(DEFAULT_TASK, 4, "expert", 0, 20.0, tmp_path, parse_operators(DEFAULT_TASK, None))
    own, live = collection._private_options(spec), PlatformOptions(tmp_path)
    assert own.data_dir == live.data_dir
    assert own.run_dir != live.run_dir
    assert own.logs_dir != live.logs_dir
    assert (own.router, own.port) != (live.router, live.port)
    for plan in (processes(own), lockstep_processes(own, rooms=2)):
        rooms = [process.id for process in plan if process.kind == ServiceKind.SIM]
        assert rooms
        assert all(room.startswith("collect-") for room in rooms)
