"""Every command that the documents name exists and takes the options they give; every link leads somewhere."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
import tarfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import click
import pytest

from mart.runtime.cli import cli
from tests.contract.repository import ROOT, files_named, listed, relative

_DOCUMENTS = files_named(".md")
_CONSOLE = re.compile(r"^```console\n(.*?)^```", re.MULTILINE | re.DOTALL)
_SPAN = re.compile(r"`((?:make|mart) [^`]+)`")
_PYTHON = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\]\((?!https?:|#)([^)#]+)")
_EPISODES = ROOT / "tests" / "fixtures" / "episodes_0_1_0" / "episodes.tar.xz"
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


def test_mart_commands_exist_with_their_options() -> None:
    offences = [
        f"{document}: `{command}`: {complaint}"
        for document, command in _NAMED
        if command.startswith("mart ") and (complaint := _complaint(command))
    ]
    assert offences == [], listed(offences)


def test_make_verbs_exist() -> None:
    offences = [
        f"{document}: `{command}`"
        for document, command in _NAMED
        if command.startswith("make ") and not all(map(_is_verb, _verbs(command)))
    ]
    assert offences == [], listed(offences)


def test_tests_that_are_named_exist() -> None:
    named = [
        (relative(path), word.partition("::"))
        for path in _DOCUMENTS
        for line in re.findall(r"^\$ \.venv/bin/pytest (.*)$", path.read_text(), re.MULTILINE)
        for word in shlex.split(line)
        if word.startswith("tests/")
    ]
    assert named
    offences = [
        f"{document}: {file}{separator}{name}"
        for document, (file, separator, name) in named
        if not (ROOT / file).exists() or (name and f"def {name}(" not in (ROOT / file).read_text())
    ]
    assert offences == [], listed(offences)


@pytest.mark.parametrize("door", ["README.md", "docs/index.md"])
def test_every_guide_is_found_from_the_front(door: str) -> None:
    text = (ROOT / door).read_text()
    pages = [path for path in (ROOT / "docs").glob("*.md") if path.name != "index.md"]
    assert [path.name for path in pages if not re.search(rf"\((docs/)?{path.name}[)#]", text)] == []


def test_the_readme_or_the_guides_name_every_verb_of_users() -> None:
    named = {verb for _, command in _NAMED if command.startswith("make ") for verb in _verbs(command)}
    assert {"run", "demo", "setup", "test", "check", "bench", "up", "down", "test-compose"} <= named


_RUNNABLE = [(path, block) for path in _DOCUMENTS for block in _PYTHON.findall(path.read_text())]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which people have recorded: its `data/episodes` holds three."""
    folder = tmp_path_factory.mktemp("recorded")
    with tarfile.open(_EPISODES) as archive:
        archive.extractall(folder / "data" / "episodes", filter="data")
    return folder


@pytest.mark.parametrize(
    ("path", "block"), _RUNNABLE, ids=lambda value: relative(value) if isinstance(value, Path) else ""
)
def test_python_examples_run(path: Path, block: str, recorded: Path) -> None:
    """Each `python` block by itself; a block that is a file of something larger says so: `python file=…`."""
    subprocess.run([sys.executable, "-W", "error", "-c", block], cwd=recorded, check=True)


def test_links_lead_somewhere() -> None:
    offences = [
        f"{relative(path)}:{number} {target}"
        for path in _DOCUMENTS
        for number, line in enumerate(path.read_text().splitlines(), 1)
        for target in _LINK.findall(line)
        if not (path.parent / target).exists()
    ]
    assert offences == [], listed(offences)


def _complaint(command: str) -> str:
    """What is wrong with a `mart` command line: a command, an option or a missing value; empty where nothing is."""
    context, words = click.Context(cli, info_name="mart"), shlex.split(command)[1:]
    while isinstance(context.command, click.Group) and words and not words[0].startswith("-"):
        found = context.command.get_command(context, words[0])
        if found is None:
            return f"there is no {words[0]!r}"
        context, words = click.Context(found, parent=context, info_name=words[0]), words[1:]
    try:
        context.command.make_parser(context).parse_args(words)
    except click.UsageError as error:
        return error.format_message()
    return ""


def _verbs(command: str) -> set[str]:
    return {word for word in shlex.split(command)[1:] if "=" not in word}


@cache
def _is_verb(word: str) -> bool:
    return (
        subprocess.run(["make", "--dry-run", word], cwd=ROOT, capture_output=True, check=False).returncode
        == 0
    )
