"""Where the repository's own files are, for tests about the repository itself."""

from __future__ import annotations

import ast
import subprocess
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
GENERATED = ("_pb2.py", "_pb2.pyi")


@cache
def tracked_files() -> tuple[Path, ...]:
    """Every file that git knows and that exists, generated code left out."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    paths = (ROOT / name for name in listed.splitlines() if not name.endswith(GENERATED))
    return tuple(path for path in paths if path.is_file())


def files_named(*suffixes: str) -> tuple[Path, ...]:
    """Every file of `tracked_files` whose name ends in one of `suffixes`."""
    return tuple(path for path in tracked_files() if path.suffix in suffixes)


def sources() -> tuple[Path, ...]:
    """The parts' Python files."""
    return tuple(path for path in files_named(".py") if "src" in path.parts)


@cache
def parsed(path: Path) -> ast.Module:
    """The syntax tree of a Python file, read once for all rules."""
    return ast.parse(path.read_text())


def projects() -> dict[str, dict[str, Any]]:
    """The `project` table of every part, by the part's folder."""
    found = (path for path in tracked_files() if path.name == "pyproject.toml" and path.parent != ROOT)
    return {str(path.parent.relative_to(ROOT)): tomllib.loads(path.read_text())["project"] for path in found}


def relative(path: Path) -> str:
    """The path as seen from the repository's top."""
    return str(path.relative_to(ROOT))


def place(path: Path, node: ast.AST | None = None) -> str:
    """`file:line`, as editors and terminals open it; the first line without a node."""
    return f"{relative(path)}:{getattr(node, 'lineno', 1)}"


def listed(offences: list[str]) -> str:
    """What an assertion says: how many offences there are, and each on a line of its own."""
    return f"{len(offences)} offences:\n" + "\n".join(offences)
