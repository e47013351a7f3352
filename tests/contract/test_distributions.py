"""Parts, versions and pins agree with each other."""

from __future__ import annotations

import re
import tomllib

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.contract.repository import ROOT, projects, tracked_files

_MAKEFILE_LIST = re.compile(r"^DISTRIBUTIONS := (.*)$", re.MULTILINE)
_RELEASE = re.compile(r"^## \[(\d+\.\d+\.\d+)\]", re.MULTILINE)


def _pins() -> dict[str, str]:
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    pinned = (line.split("==") for line in lines if line and not line.startswith("#"))
    return {canonicalize_name(name): version for name, version in pinned}


def _tools() -> list[str]:
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text())["dependency-groups"]
    return [requirement for group in groups.values() for requirement in group]


def test_the_makefile_lists_every_part() -> None:
    match = _MAKEFILE_LIST.search((ROOT / "Makefile").read_text())
    assert match is not None
    assert sorted(match[1].split()) == sorted(projects())


def test_the_changelog_tells_the_version_that_every_part_has() -> None:
    newest = _RELEASE.search((ROOT / "CHANGELOG.md").read_text())
    assert newest is not None
    assert {folder: project["version"] for folder, project in projects().items()} == dict.fromkeys(
        projects(), newest[1]
    )


def test_what_is_cited_is_this_version() -> None:
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert {cited["version"]} == {project["version"] for project in projects().values()}
    assert {cited["license"]} == {project["license"] for project in projects().values()}


@pytest.mark.parametrize("folder", [*projects(), "tools"])
def test_everything_that_is_needed_is_pinned(folder: str) -> None:
    needed = _tools() if folder == "tools" else projects()[folder]["dependencies"]
    names = {canonicalize_name(Requirement(text).name) for text in needed}
    parts = {canonicalize_name(project["name"]) for project in projects().values()}
    assert names - parts - set(_pins()) == set()


def test_cuda_stays_out() -> None:
    # The pins hold for machines without a GPU too: what a GPU needs comes with the torch that its owner installs.
    assert {name for name in _pins() if name.startswith(("nvidia", "cuda", "triton"))} == set()


def test_pytorch_and_what_finds_its_cpu_build_are_pinned() -> None:
    assert {"torch", "uv"} <= set(_pins())


def test_pins_name_versions_and_never_places() -> None:
    text = (ROOT / "constraints.txt").read_text()
    assert "://" not in text
    assert "-e " not in text
    assert " @ " not in text


def test_mart_is_a_namespace_that_no_part_owns() -> None:
    assert [
        path for path in tracked_files() if path.name == "__init__.py" and path.parent.name == "mart"
    ] == []


@pytest.mark.parametrize("folder", projects())
def test_every_part_says_that_it_is_typed(folder: str) -> None:
    packages = [path.parent for path in (ROOT / folder / "src" / "mart").glob("*/__init__.py")]
    assert packages
    assert [package.name for package in packages if not (package / "py.typed").exists()] == []
