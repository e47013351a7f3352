"""Rules about code that neither the linter nor import-linter can state: each lists all that break it, as file:line."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator

from tests.contract.repository import ROOT, files_named, listed, parsed, place, relative, sources

_LONGEST_FILE_LINES = 300
_LONGEST_FUNCTION_LINES = 60
_CLOCK_READS = {"now", "utcnow", "today"}
_CLOCK_FILE = "protocol/src/mart/protocol/clock.py"
_PICKLING = {"pickle", "dill", "cloudpickle", "joblib", "marshal", "shelve"}
_SKIPPING = {"skip", "skipif", "importorskip", "xfail"}


def test_files_stay_short() -> None:
    lengths = {
        path: len(path.read_text().splitlines()) for path in files_named(".py", ".css", ".js", ".html", ".c")
    }
    long = {path: lines for path, lines in lengths.items() if lines > _LONGEST_FILE_LINES}
    offences = [f"{place(path)} has {lines} lines" for path, lines in long.items()]
    assert offences == [], listed(offences)


def test_functions_stay_short() -> None:
    offences = [
        f"{place(path, node)} {node.name} has {lines} lines"
        for path in files_named(".py")
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and (lines := (node.end_lineno or node.lineno) - node.lineno + 1) > _LONGEST_FUNCTION_LINES
    ]
    assert offences == [], listed(offences)


def test_a_class_name_means_one_thing() -> None:
    """Names of the parts' classes, private ones and generated messages excepted."""
    places: defaultdict[str, list[str]] = defaultdict(list)
    for path in sources():
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(place(path, node))
    offences = [f"{name}: {', '.join(found)}" for name, found in sorted(places.items()) if len(found) > 1]
    assert offences == [], listed(offences)


def test_requests_are_answered_by_the_serving_helper() -> None:
    """So that whatever a handler raises is an answer, and no service ends over a question."""
    offences = [
        f"{place(path, node)} calls {ast.unparse(node.func)}"
        for path in sources()
        if not relative(path).startswith("libraries/runtime/")
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "reply"
        and ast.unparse(node.func.value) == "request"
    ]
    assert offences == [], listed(offences)


def test_dates_come_from_the_clock_module() -> None:
    # `time` itself is forbidden by import-linter; datetime is needed to format, so only its clock reads are.
    offences = [
        f"{place(path, node)} reads {ast.unparse(node)}"
        for path in sources()
        if relative(path) != _CLOCK_FILE
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.Attribute) and node.attr in _CLOCK_READS
    ]
    assert offences == [], listed(offences)


def test_nothing_is_pickled() -> None:
    offences = [
        f"{place(path, node)} imports {name}"
        for path in files_named(".py")
        for node in ast.walk(parsed(path))
        for name in _imported(node)
        if name in _PICKLING
    ]
    assert offences == [], listed(offences)


def test_no_test_is_skipped() -> None:
    offences = [
        f"{place(path, node)} {ast.unparse(node)}"
        for path in files_named(".py")
        if path.is_relative_to(ROOT / "tests")
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.Attribute) and node.attr in _SKIPPING
    ]
    assert offences == [], listed(offences)


def _imported(node: ast.AST) -> Iterator[str]:
    match node:
        case ast.Import():
            yield from (alias.name for alias in node.names)
        case ast.ImportFrom(module=str(module)):
            yield module
        case _:
            pass
