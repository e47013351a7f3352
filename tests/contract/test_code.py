"""Rules about code that neither the linter nor import-linter can state."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.contract.repository import relative, sources, tracked_files

_LONGEST_FILE_LINES = 300
_LONGEST_FUNCTION_LINES = 60
_CLOCK_READS = {"now", "utcnow", "today"}
_CLOCK_FILE = "protocol/src/mart/protocol/clock.py"

_PYTHON = [path for path in tracked_files() if path.suffix == ".py"]


def _nodes(path: Path) -> Iterator[ast.AST]:
    return ast.walk(ast.parse(path.read_text()))


@pytest.mark.parametrize("path", _PYTHON, ids=relative)
def test_files_and_functions_stay_short(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= _LONGEST_FILE_LINES
    functions = (node for node in _nodes(path) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef))
    lengths = {node.name: (node.end_lineno or node.lineno) - node.lineno + 1 for node in functions}
    assert {name: lines for name, lines in lengths.items() if lines > _LONGEST_FUNCTION_LINES} == {}


@pytest.mark.parametrize("path", sources(), ids=relative)
def test_dates_come_from_the_clock_module(path: Path) -> None:
    # `time` itself is forbidden by import-linter; datetime is needed to format, so only its clock reads are.
    reads = [node for node in _nodes(path) if isinstance(node, ast.Attribute) and node.attr in _CLOCK_READS]
    assert relative(path) == _CLOCK_FILE or [ast.unparse(node) for node in reads] == []


@pytest.mark.parametrize("path", _PYTHON, ids=relative)
def test_nothing_is_pickled(path: Path) -> None:
    imported = {alias.name for node in _nodes(path) if isinstance(node, ast.Import) for alias in node.names}
    imported |= {node.module for node in _nodes(path) if isinstance(node, ast.ImportFrom) and node.module}
    assert imported & {"pickle", "dill", "cloudpickle", "joblib", "marshal", "shelve"} == set()


@pytest.mark.parametrize("path", [path for path in _PYTHON if "tests" in path.parts], ids=relative)
def test_no_test_is_skipped(path: Path) -> None:
    names = {node.attr for node in _nodes(path) if isinstance(node, ast.Attribute)}
    assert names & {"skip", "skipif", "importorskip", "xfail"} == set()
