"""The figures that the parts declare are named as Prometheus asks, and the dashboard and the alerts know no others."""

from __future__ import annotations

import json
import re
from importlib import import_module
from typing import Any

import pytest
import yaml

from mart.runtime import metrics, serving
from tests.contract.repository import ROOT
from tests.support.metric_lint import complaints

_MONITORING = ROOT / "deploy" / "monitoring"
_WORD = re.compile(r"\b(?:mart|process|python)_[a-z0-9_]+\b")
_LABEL = re.compile(r"(?:by|on|without) *\(([^)]*)\)|(\w+) *=~?\"")
_GIVEN_BY_PROMETHEUS = {"job", "instance", "service", "id", "le"}
_MAX_LABELS = 3


def _declaring_modules() -> list[str]:
    """Every module of a part that is named for its figures."""
    found = [path.relative_to(ROOT) for path in ROOT.glob("services/*/src/mart/**/*_metrics.py")]
    assert len(found) >= 6
    return [".".join(path.with_suffix("").parts[3:]) for path in found]


@pytest.fixture(scope="module")
def declared() -> list[Any]:
    """Everything on the registry once every part has declared its figures."""
    assert serving.REQUEST is not None
    for module in _declaring_modules():
        import_module(module)
    return list(metrics.REGISTRY.collect())


def _series(metric: Any) -> set[str]:
    suffixes = {
        "counter": ("_total",),
        "summary": ("_sum", "_count"),
        "histogram": ("_bucket", "_sum", "_count"),
    }
    return {metric.name + suffix for suffix in suffixes.get(metric.type, ("",))}


def _expressions() -> list[str]:
    dashboard = json.loads((_MONITORING / "grafana/dashboards/mart.json").read_text())
    shown = [target["expr"] for panel in dashboard["panels"] for target in panel.get("targets", ())]
    listed = [variable["query"]["query"] for variable in dashboard["templating"]["list"]]
    return [*shown, *listed, *(rule["expr"] for rule in _rules())]


def _rules() -> list[dict[str, Any]]:
    (group,) = yaml.safe_load((_MONITORING / "alerts.yml").read_text())["groups"]
    rules: list[dict[str, Any]] = group["rules"]
    return rules


def test_figures_are_named_and_explained_as_prometheus_asks(declared: list[Any]) -> None:
    assert complaints(declared) == []


def test_the_dashboard_and_the_alerts_use_only_figures_that_parts_declare(declared: list[Any]) -> None:
    known = set().union(*map(_series, declared))
    used = {word for expression in _expressions() for word in _WORD.findall(expression)}
    assert used - known == set()


def test_every_figure_of_ours_is_looked_at_by_the_dashboard_or_an_alert(declared: list[Any]) -> None:
    used = {word for expression in _expressions() for word in _WORD.findall(expression)}
    ours = {metric.name: _series(metric) for metric in declared if metric.name.startswith("mart_")}
    assert [name for name, series in ours.items() if not series & used] == ["mart_service_info"]


def test_the_dashboard_and_the_alerts_use_only_labels_that_exist() -> None:
    labels = {label for names in _declared_labels().values() for label in names} | _GIVEN_BY_PROMETHEUS
    for expression in _expressions():
        for group, single in _LABEL.findall(expression):
            assert {label.strip() for label in (group or single).split(",")} <= labels, expression


def test_labels_are_few_and_name_no_person_and_no_episode() -> None:
    allowed = {
        *("room", "arm", "camera", "phase", "operator", "good", "statistic", "stage", "what", "verdict"),
        *("state", "kind", "name", "version", "queryable", "error"),  # `name` is a service's
    }
    for figure, labels in _declared_labels().items():
        assert set(labels) <= allowed, figure
        assert len(labels) <= _MAX_LABELS, figure


def test_alerts_say_what_is_wrong_and_what_to_do_and_cover_what_a_lab_wants() -> None:
    for rule in _rules():
        assert rule["labels"]["severity"] in ("warning", "critical")
        assert all(rule["annotations"][part].endswith(".") for part in ("summary", "description"))
    assert {rule["alert"] for rule in _rules()} >= {
        "DiskIsNearlyFull",
        "RecorderLags",
        "PartRestarts",
        "RoomIsSlow",
        "VerificationQueueIsLong",
    }


def test_prometheus_follows_the_files_that_processes_write() -> None:
    configuration = yaml.safe_load((_MONITORING / "prometheus.yml").read_text())
    (job,) = configuration["scrape_configs"]
    assert job["job_name"] == "mart"
    assert job["file_sd_configs"][0]["files"] == ["/metrics/*.json"]
    assert all((_MONITORING / name).is_file() for name in configuration["rule_files"])


def _declared_labels() -> dict[str, tuple[str, ...]]:
    """The names of the labels of each figure of ours."""
    modules = [metrics, serving, *map(import_module, _declaring_modules())]
    figures = [
        value for module in modules for value in vars(module).values() if hasattr(value, "_labelnames")
    ]
    return {
        figure._name: tuple(figure._labelnames) for figure in figures
    }  # the library has no other way to ask
