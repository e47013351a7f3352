"""Every command that the documents name exists and takes the options they give; every link leads somewhere."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from mart.runtime.cli import cli
from tests.contract.repository import ROOT, relative, tracked_files

_DOCUMENTS = [path for path in tracked_files() if path.suffix == ".md"]
_CONSOLE = re.compile(r"^```console\n(.*?)^```", re.MULTILINE | re.DOTALL)
_SPAN = re.compile(r"`((?:make|mart) [^`]+)`")
_PYTHON = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\]\((?!https?:|#)([^)#]+)")
_HEADING_OR_PLACEHOLDER = re.compile(r"…|[\[\]|{}<>]")


def _commands(path: Path) -> Iterator[str]:
    """`make` and `mart` command lines in console blocks (after `$ `) and in code spans."""
    text = path.read_text()
    lines = [
        line[2:] for block in _CONSOLE.findall(text) for line in block.splitlines() if line.startswith("$ ")
    ]
    for line in lines + _SPAN.findall(text):
        for command in re.split(r"&&|;|\|(?!\|)", line.split(" #")[0]):
            if command.split()[:1] in (["make"], ["mart"]) and not _HEADING_OR_PLACEHOLDER.search(command):
                yield command.strip()


_NAMED = sorted({(relative(path), command) for path in _DOCUMENTS for command in _commands(path)})
_MART = [pair for pair in _NAMED if pair[1].startswith("mart ")]
_MAKE = [pair for pair in _NAMED if pair[1].startswith("make ")]


@pytest.mark.parametrize(("document", "command"), _MART)
def test_mart_commands_exist_with_their_options(document: str, command: str) -> None:
    context, words = click.Context(cli, info_name="mart"), shlex.split(command)[1:]
    while isinstance(context.command, click.Group) and words and not words[0].startswith("-"):
        found = context.command.get_command(context, words[0])
        assert found is not None, f"{document} names `{command}`, which does not exist"
        context, words = click.Context(found, parent=context, info_name=words[0]), words[1:]
    context.command.make_parser(context).parse_args(words)  # raises for an unknown option or a missing value


@pytest.mark.parametrize(("document", "command"), _MAKE)
def test_make_verbs_exist(document: str, command: str) -> None:
    verbs = [word for word in shlex.split(command)[1:] if "=" not in word]
    subprocess.run(["make", "--dry-run", *verbs], cwd=ROOT, capture_output=True, check=True)


@pytest.mark.parametrize(
    "verb", ["run", "demo", "setup", "test", "check", "bench", "up", "down", "test-compose"]
)
def test_the_readme_or_the_guides_name_every_verb(verb: str) -> None:
    assert any(verb in command.split() for _, command in _MAKE)


_RUNNABLE = [(path, block) for path in _DOCUMENTS for block in _PYTHON.findall(path.read_text())]


@pytest.mark.parametrize(
    ("path", "block"), _RUNNABLE, ids=lambda value: relative(value) if isinstance(value, Path) else ""
)
def test_python_examples_run(path: Path, block: str, tmp_path: Path) -> None:
    """Each `python` block by itself; a block that is a file of something larger says so: `python file=…`."""
    subprocess.run([sys.executable, "-W", "error", "-c", block], cwd=tmp_path, check=True)


@pytest.mark.parametrize("path", _DOCUMENTS, ids=relative)
def test_links_lead_somewhere(path: Path) -> None:
    targets = _LINK.findall(path.read_text())
    assert [target for target in targets if not (path.parent / target).exists()] == []
