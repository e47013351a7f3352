"""A platform that is watched: Prometheus finds every process, also those that come and go, and reads its figures."""

from __future__ import annotations

import json
import urllib.request
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from prometheus_client.parser import text_string_to_metric_families

from mart.platform.run.plan import PlatformOptions, training_processes
from mart.platform.run.running import Platform, running_platform
from mart.protocol import clock
from mart.protocol.messages import OPERATOR_SCRIPT, SeatRequest
from mart.runtime.ports import free_port
from tests.support.metric_lint import complaints, promtool_complaints
from tests.system.room_client import RoomClient

_LOOK_EVERY_S, _PATIENCE_S = 0.05, 60.0
_HOLDER = "a-secret-of-its-holder"
# A figure of each part that is there from the beginning.
_FIGURES = {
    "sim": "mart_room_real_time_factor",
    "recorder": "mart_recorder_lag_seconds",
    "gateway": "mart_gateway_seats",
    "seat": "mart_seat_picture_rate_hertz",
    "web": "mart_web_connections",
    "trainer": "mart_trainer_jobs",
    "replica": "mart_request_seconds",
    "catalogue": "mart_request_seconds",
}

Families = dict[str, Any]


@pytest.fixture(scope="module")
def platform(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Platform]:
    """A platform with a trainer, in whose room a script drives one arm."""
    options = PlatformOptions(
        tmp_path_factory.mktemp("watched"), router=f"tcp/127.0.0.1:{free_port()}", port=free_port()
    )
    options = replace(options, metrics=True)
    with running_platform(options, training_processes(options)) as platform:
        with RoomClient(options.router, options.room) as room:
            room.assign("arm1", OPERATOR_SCRIPT)
        yield platform


def _awaited(folder: Path, name: str, *, there: bool = True) -> dict[str, Any]:
    """What a process told Prometheus, once it did; or nothing, once it is gone."""
    path, deadline_s = folder / f"{name}.json", clock.monotonic_s() + _PATIENCE_S
    while path.exists() is not there:
        assert clock.monotonic_s() < deadline_s, f"{name}: {sorted(folder.iterdir())}"
        clock.sleep_s(_LOOK_EVERY_S)
    (target,) = json.loads(path.read_text()) if there else ({},)
    return dict(target)


def _scraped(target: dict[str, Any]) -> bytes:
    (address,) = target["targets"]
    with urllib.request.urlopen(f"http://{address}/metrics", timeout=30) as reply:
        body: bytes = reply.read()
    return body


def _families(exposition: bytes) -> Families:
    return {family.name: family for family in text_string_to_metric_families(exposition.decode())}


def _value(families: Families, name: str, **labels: str) -> float:
    family = families[name.removesuffix("_total")]
    (value,) = (s.value for s in family.samples if s.name == name and labels.items() <= s.labels.items())
    return float(value)


@pytest.mark.timeout(240)
def test_every_process_shows_its_figures_as_promtool_asks(platform: Platform) -> None:
    folder = platform.options.metrics_dir
    with RoomClient(platform.options.router, "room-1") as room:
        room.claim("arm0", _HOLDER)
    planned = [f"{process.kind}-{process.id}" for process in training_processes(platform.options)]
    for name in ("seat-room-1-arm0", *planned):
        target = _awaited(folder, name)
        exposition = _scraped(target)
        families = _families(exposition)
        assert complaints(families.values()) == [], name
        assert promtool_complaints(exposition) == "", name
        assert _value(families, "process_resident_memory_bytes") > 1e6
        assert _value(families, "mart_service_info", kind=target["labels"]["service"]) == 1
        assert _FIGURES.get(target["labels"]["service"], "mart_service_info") in families, name


@pytest.mark.timeout(120)
def test_figures_are_those_that_the_room_says_and_a_seat_that_is_left_is_no_target_any_more(
    platform: Platform,
) -> None:
    folder = platform.options.metrics_dir
    sim = _awaited(folder, "sim-room-1")
    with RoomClient(platform.options.router, "room-1") as room:
        room.claim("arm0", _HOLDER)
        _awaited(folder, "seat-room-1-arm0")
        # The person says nothing, so the room waits for them: nothing but the script drives.
        silent = room.statuses.wait_for(lambda status: any(w.since_s > 1.0 for w in status.waiting_for))
        families = _families(_scraped(sim))
        assert (
            _value(families, "mart_room_silence_seconds", arm="arm0") >= silent.waiting_for[0].since_s - 0.5
        )
        assert _value(families, "mart_room_silence_seconds", arm="arm1") == 0.0
        assert _value(families, "mart_room_seats", operator="script") == 1
        assert _value(families, "mart_room_seats", operator="human") == 1
        assert _value(families, "mart_room_states_total") > 0
        released = room.seat(SeatRequest(release=SeatRequest.Release(arm="arm0", holder_id=_HOLDER)))
        assert not released.HasField("error")
        room.states.wait_for(lambda state: state.tick > silent.tick + 5, timeout_s=30.0)
    _awaited(folder, "seat-room-1-arm0", there=False)
    families = _families(_scraped(sim))
    assert _value(families, "mart_room_states_total") > silent.tick
    assert _value(families, "mart_room_seats", operator="human") == 0
