"""`/metrics` of a process: there when a port is given, found by Prometheus, in nobody's way."""

from __future__ import annotations

import json
import logging
import socket
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from prometheus_client.parser import text_string_to_metric_families

from mart.protocol.errors import InvalidInput
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.metrics import served_metrics, targets
from mart.runtime.settings import Settings


def _told(folder: Path) -> dict[str, Any]:
    ((target,),) = (json.loads(path.read_text()) for path in folder.glob("*.json"))
    return dict(target)


def test_nothing_listens_unless_a_port_is_given(tmp_path: Path) -> None:
    with served_metrics(Settings(metrics_targets_dir=tmp_path), ServiceKind.SIM, "room-1"):
        assert list(tmp_path.iterdir()) == []


def test_a_process_says_where_it_is_and_shows_its_figures_there_until_it_ends(tmp_path: Path) -> None:
    settings = Settings(metrics_port=0, metrics_targets_dir=tmp_path)
    with served_metrics(settings, ServiceKind.SIM, "room-1"):
        target = _told(tmp_path)
        assert target["labels"] == {"instance": "sim/room-1", "service": "sim", "id": "room-1"}
        (address,) = target["targets"]
        assert address.startswith("127.0.0.1:")
        with urllib.request.urlopen(f"http://{address}/metrics") as reply:
            families = {family.name for family in text_string_to_metric_families(reply.read().decode())}
        assert {"mart_service_info", "process_resident_memory_bytes"} <= families
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(f"http://{address}/")
    assert list(tmp_path.iterdir()) == []


def test_whoever_connects_and_says_nothing_or_goes_away_keeps_nobody_from_the_figures_for_long(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mart.runtime.metrics._MetricsHandler.timeout", 0.05)
    with served_metrics(Settings(metrics_port=0, metrics_targets_dir=tmp_path), ServiceKind.WEB, "web"):
        (address,) = _told(tmp_path)["targets"]
        host, _, port = address.rpartition(":")
        with socket.create_connection((host, int(port))) as silent:
            socket.create_connection((host, int(port))).close()
            with urllib.request.urlopen(f"http://{address}/metrics", timeout=10) as reply:
                assert reply.status == 200
            assert silent.recv(1) == b""


def test_a_port_that_is_taken_costs_the_figures_and_says_so_but_never_the_service(
    caplog: pytest.LogCaptureFixture,
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with (
            caplog.at_level(logging.ERROR),
            served_metrics(Settings(metrics_port=port), ServiceKind.WEB, "web"),
        ):
            assert f"127.0.0.1 port {port}" in caplog.text
            assert "MART_METRICS_PORT" in caplog.text


def test_the_file_of_a_later_process_of_the_same_name_stays(tmp_path: Path) -> None:
    settings = Settings(metrics_port=0, metrics_targets_dir=tmp_path)
    later = targets("127.0.0.1", 1, ServiceKind.SIM, "room-1")
    with served_metrics(settings, ServiceKind.SIM, "room-1"):
        (tmp_path / "sim-room-1.json").write_bytes(later)
    assert (tmp_path / "sim-room-1.json").read_bytes() == later


def test_an_address_of_ipv6_is_in_brackets() -> None:
    assert json.loads(targets("::1", 9, ServiceKind.WEB, "web"))[0]["targets"] == ["[::1]:9"]


def test_ports_that_cannot_be_are_refused() -> None:
    with pytest.raises(InvalidInput):
        Settings(metrics_port=70_000)
