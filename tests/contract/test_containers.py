"""What docker-compose.yml and the Dockerfiles promise, read without an engine."""

from __future__ import annotations

import re
from typing import Any

import click
import pytest
import yaml
from packaging.requirements import Requirement

from mart.platform.run.turn_server import configuration
from mart.runtime.cli import cli
from tests.contract.repository import ROOT, projects

_CONTAINERS: dict[str, dict[str, Any]] = yaml.safe_load((ROOT / "docker-compose.yml").read_text())["services"]
_SERVICES = {name: service for name, service in _CONTAINERS.items() if "profiles" not in service}
_MONITORING = {
    name: service for name, service in _CONTAINERS.items() if service.get("profiles") == ["monitoring"]
}
_BUILDS = {name: service["build"] for name, service in _SERVICES.items() if "build" in service}
_VARIABLE = re.compile(r"\$\{\w+:-([^}]*)\}")


def _with_defaults(text: str) -> str:
    return _VARIABLE.sub(r"\1", text)


@pytest.mark.parametrize("name", _SERVICES)
def test_every_command_parses(name: str) -> None:
    words = [_with_defaults(word) for word in _SERVICES[name]["command"]]
    context = click.Context(cli)
    command = cli.get_command(context, words[0])
    assert command is not None
    command.make_parser(click.Context(command, parent=context)).parse_args(words[1:])


@pytest.mark.parametrize("name", _CONTAINERS)
def test_every_container_is_confined_and_restarted(name: str) -> None:
    service = _CONTAINERS[name]
    assert service["read_only"]
    assert service["cap_drop"] == ["ALL"]
    assert service["restart"] == "unless-stopped"
    if name in _SERVICES and name != "router":
        assert service["depends_on"] == {"router": {"condition": "service_healthy"}}


@pytest.mark.parametrize("name", _SERVICES)
def test_every_container_has_the_bus_secret_and_only_the_router_can_change_it(name: str) -> None:
    service = _SERVICES[name]
    assert service["environment"]["MART_BUS_SECRET_FILE"] == "/bus/secret"
    assert ("bus:/bus" if name == "router" else "bus:/bus:ro") in service["volumes"]


def test_only_the_web_service_listens_and_only_on_loopback_unless_asked() -> None:
    listening = {name: service["ports"] for name, service in _SERVICES.items() if "ports" in service}
    assert list(listening) == ["web"]
    assert all(_with_defaults(port).startswith("127.0.0.1:") for port in listening["web"])


def test_what_watches_is_pinned_listens_on_loopback_alone_and_is_there_only_when_asked() -> None:
    assert set(_MONITORING) == set(_CONTAINERS) - set(_SERVICES) == {"prometheus", "grafana"}
    for service in _MONITORING.values():
        assert re.fullmatch(r"\S+:v?\d+\.\d+\.\d+", service["image"])
        assert all(port.startswith("127.0.0.1:") for port in service["ports"])


@pytest.mark.parametrize("name", _SERVICES)
def test_every_container_tells_prometheus_where_its_figures_are_once_a_port_is_given(name: str) -> None:
    service = _SERVICES[name]
    assert "metrics:/metrics" in service["volumes"]
    assert service["environment"]["MART_METRICS_TARGETS_DIR"] == "/metrics"
    assert service["environment"]["MART_METRICS_PORT"] is None  # as it is outside


def test_the_relay_of_containers_is_that_of_mart_run() -> None:
    words = yaml.safe_load((ROOT / "docker-compose.lan.yml").read_text())["services"]["turn"]["command"]
    in_containers = {_with_defaults(word).removeprefix("--") for word in words}
    with_run = configuration("", ["127.0.0.1"], "203.0.113.7").split()
    differing = ("external-ip=", "allowed-peer-ip=")
    assert {word for word in in_containers if not word.startswith(differing)} == {
        word for word in with_run if not word.startswith(differing)
    }
    assert {"allowed-peer-ip=127.0.0.1", "external-ip=127.0.0.1"} <= in_containers


def test_images_are_slim_watched_and_not_root() -> None:
    text = (ROOT / "Dockerfile").read_text()
    assert re.findall(r"^FROM (\S+)", text, re.MULTILINE) == ["debian:bookworm-slim"] * 2
    assert "HEALTHCHECK" in text
    assert re.findall(r"^USER (\w+)", text, re.MULTILINE) == ["mart"]
    assert "://" not in text


@pytest.mark.parametrize("name", _BUILDS)
def test_an_image_is_built_from_a_part_and_watches_the_service_that_it_runs(name: str) -> None:
    arguments = _BUILDS[name]["args"]
    assert (ROOT / arguments["PART"] / "pyproject.toml").is_file()
    assert arguments["SERVICE"] == _SERVICES[name]["command"][0]
    text = (ROOT / "Dockerfile").read_text()
    assert set(arguments) <= set(re.findall(r"^ARG (\w+)", text, re.MULTILINE))


def test_every_service_has_an_image() -> None:
    beside_hardware = {"services/driver"}  # which a container cannot reach
    services = {folder for folder in projects() if folder.startswith("services/")} - beside_hardware
    assert {build["args"]["PART"] for build in _BUILDS.values()} == services | {"libraries/runtime"}


@pytest.mark.parametrize("name", _BUILDS)
def test_an_image_holds_the_libraries_that_its_part_needs_and_no_others(name: str) -> None:
    arguments = _BUILDS[name]["args"]
    by_name = {project["name"]: folder for folder, project in projects().items()}

    def needed(folder: str) -> set[str]:
        names = {Requirement(text).name for text in projects()[folder]["dependencies"]}
        direct = {by_name[name] for name in names & by_name.keys()}
        return direct.union(*map(needed, direct))

    libraries = needed(arguments["PART"]) - {"protocol"}
    assert {word.removeprefix("./") for word in arguments.get("LIBRARIES", "").split()} == libraries


@pytest.mark.parametrize("name", _BUILDS)
def test_an_image_that_holds_pytorch_asks_for_its_cpu_build(name: str) -> None:
    arguments = _BUILDS[name]["args"]
    needed = {Requirement(text).name for text in projects()[arguments["PART"]]["dependencies"]}
    assert ("torch" in needed) == ("CPU_TORCH" in arguments)
