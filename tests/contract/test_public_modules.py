"""What the site's reference shows of the public modules is said in their docstrings."""

from __future__ import annotations

import re
from collections.abc import Iterator

import griffe
import pytest

from tests.contract.repository import ROOT, listed, projects

_DIRECTIVE = re.compile(r"^::: (\S+)$", re.MULTILINE)
_IN_NAVIGATION = re.compile(r"^ +- [\w.]+: (reference/\w+\.md)$", re.MULTILINE)

# What is not mended yet: this only ever becomes smaller.
_STILL_UNDOCUMENTED = 10


@pytest.fixture(scope="module")
def modules() -> list[griffe.Object]:
    """Every public module, read and not imported, as the site does."""
    loader = griffe.GriffeLoader(search_paths=[ROOT / folder / "src" for folder in projects()])
    pages = _IN_NAVIGATION.findall((ROOT / "mkdocs.yml").read_text())
    names = [name for page in pages for name in _DIRECTIVE.findall((ROOT / "docs" / page).read_text())]
    loaded = [loader.load(name) for name in names]
    loader.resolve_aliases()
    return [module for module in loaded if isinstance(module, griffe.Object)]


def test_every_public_module_says_what_is_public(modules: list[griffe.Object]) -> None:
    assert modules
    assert [module.path for module in modules if not module.exports] == []


def test_every_public_name_is_documented(modules: list[griffe.Object]) -> None:
    """Functions, classes, their methods and properties: the site leaves out what has no docstring."""
    offences = [
        f"{one.relative_filepath}:{one.lineno} {one.path}"
        for module in modules
        for name in module.exports or ()
        for one in _parts(module[str(name)])
        if not one.has_docstring
    ]
    assert len(offences) <= _STILL_UNDOCUMENTED, listed(offences)


def _parts(named: griffe.Object | griffe.Alias) -> Iterator[griffe.Object]:
    target = named.final_target if isinstance(named, griffe.Alias) else named
    if target.is_function or target.is_class:
        yield target
    if target.is_class:
        own = (one for one in target.members.values() if isinstance(one, griffe.Object))
        public = (one for one in own if one.is_public and one.name != "__init__")
        yield from (one for one in public if one.is_function or "property" in one.labels)
