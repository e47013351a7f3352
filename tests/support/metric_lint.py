"""The rules of `promtool check metrics`, for where that is not installed; its own word is taken too where it is."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterable
from typing import Any

# https://github.com/prometheus/client_golang/tree/main/prometheus/testutil/promlint
_NO_BASE_UNITS = (
    *("milliseconds", "microseconds", "nanoseconds", "minutes", "hours", "days", "ms", "ns", "us"),
    *("kilobytes", "megabytes", "gigabytes", "kb", "mb", "gb", "bits", "percent", "percents"),
    *("milliamperes", "kilometers", "millimeters", "centimeters", "millivolts", "kilohertz", "celsiuses"),
)
_TYPES = ("counter", "gauge", "histogram", "summary")
_RESERVED = ("_total", "_sum", "_count", "_bucket")


def complaints(metrics: Iterable[Any]) -> list[str]:
    """Return what is wrong with the names and explanations of metrics as `prometheus_client` collects or parses them.

    A counter's name is that without `_total`, which the library adds.
    """
    return [f"{metric.name}: {fault}" for metric in metrics for fault in _faults(metric)]


def promtool_complaints(exposition: bytes) -> str:
    """Return what promtool says of an exposition; nothing where it is content, or not installed."""
    promtool = shutil.which("promtool")
    if promtool is None:
        return ""
    done = subprocess.run([promtool, "check", "metrics"], input=exposition, capture_output=True, check=False)
    return (done.stdout + done.stderr).decode() if done.returncode else ""


def _faults(metric: Any) -> Iterable[str]:
    name: str = metric.name
    words = name.split("_")
    if not metric.documentation:
        yield "has no help"
    if metric.type not in _TYPES:
        yield f"is a {metric.type}"
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        yield "is not in snake case"
    if metric.type in words:
        yield "says its type"
    if any(word in _NO_BASE_UNITS for word in words):
        yield "is in no base unit"
    if name.endswith(_RESERVED):
        yield "ends like a series of another type"
    yield from _faults_of_samples(metric)


def _faults_of_samples(metric: Any) -> Iterable[str]:
    for sample in metric.samples:
        if metric.type == "counter" and not sample.name.endswith("_total"):
            yield f"has a sample {sample.name}"
        if metric.type != "histogram" and "le" in sample.labels:
            yield "has the label le"
        if metric.type != "summary" and "quantile" in sample.labels:
            yield "has the label quantile"
