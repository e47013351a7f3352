"""Write labels as lines of JSON and read them back. Pure.

A line says one thing about one file (`path`), or the same about up to 500 at once (`paths`): putting 10,000 episodes
into a data set is 20 lines. Where it is read, a line says as many labels as it names files.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import groupby
from typing import Any

from mart.episodes.label import Label, LabelKind
from mart.protocol.errors import InvalidInput
from mart.runtime.json_lines import json_line, json_object

MAX_PATHS = 500  # of a line: 8 MB, where each has the longest name


def lines_of(labels: Iterable[Label]) -> list[bytes]:
    """Return the lines, without their ends, that labels are written as, in their order.

    Labels in a row that say the same of several files share a line.
    """
    return [
        json_line(_fields(shared, paths[start : start + MAX_PATHS]))
        for shared, same in groupby(labels, _but_for_path)
        for paths in [[label.path for label in same]]
        for start in range(0, len(paths), MAX_PATHS)
    ]


def line_of(label: Label) -> bytes:
    """Return the line, without its end, that says one label alone."""
    return json_line(_fields(_but_for_path(label), [label.path]))


def labels_of(line: bytes) -> list[Label]:
    """Return what a line says; nothing where it is none that this version knows."""
    try:
        return parse(line)
    except (ValueError, KeyError, InvalidInput):
        return []


def parse(line: bytes) -> list[Label]:
    """Return what a line says. Raises ValueError, KeyError or InvalidInput where it is none that this version knows."""
    fields = json_object(line)
    if fields is None:
        raise ValueError("it is not one JSON object")
    at_ns, detail, by = fields["at_ns"], fields.get("detail", ""), fields.get("by", "")
    paths = _paths(fields)
    said = *paths, fields["kind"], fields["value"], detail, by
    if not isinstance(at_ns, int) or not all(isinstance(text, str) for text in said):
        raise ValueError("its time is no whole number, or what it says no text")
    kind, value = LabelKind(fields["kind"]), fields["value"]
    return [Label(path, kind, value, at_ns, detail, by) for path in paths]


def _paths(fields: Mapping[str, Any]) -> list[Any]:
    if "paths" not in fields:
        return [fields["path"]]
    paths = fields["paths"]
    if not isinstance(paths, list) or not 0 < len(paths) <= MAX_PATHS or "path" in fields:
        raise ValueError(f"it must name one file, or 1 to {MAX_PATHS} as a list")
    return paths


def _but_for_path(label: Label) -> tuple[int, LabelKind, str, str, str]:
    return label.at_ns, label.kind, label.value, label.detail, label.by


def _fields(shared: tuple[int, LabelKind, str, str, str], paths: list[str]) -> dict[str, object]:
    at_ns, kind, value, detail, by = shared
    named: dict[str, object] = {"path": paths[0]} if len(paths) == 1 else {"paths": paths}
    fields: dict[str, object] = {"at_ns": at_ns, **named, "kind": kind.value, "value": value}
    return fields | {name: text for name, text in (("detail", detail), ("by", by)) if text}
