"""The files that a hosting service and git hooks read name commands that exist."""

from __future__ import annotations

import shlex
from typing import Any

import yaml

from tests.contract.repository import ROOT, files_named, relative


def _read(name: str) -> Any:
    return yaml.safe_load((ROOT / name).read_text())


def test_the_workflow_runs_what_everybody_runs_on_every_debian() -> None:
    job = _read(".github/workflows/ci.yml")["jobs"]["check-and-test"]
    assert ".ci/run" in [step.get("run") for step in job["steps"]]
    assert job["strategy"]["matrix"]["system"] == ["debian:12", "debian:13"]
    assert (ROOT / ".ci/run").stat().st_mode & 0o111


def test_hooks_run_pinned_tools() -> None:
    entries = [
        hook["entry"]
        for repository in _read(".pre-commit-config.yaml")["repos"]
        for hook in repository["hooks"]
    ]
    assert entries
    for entry in entries:
        program, *words = shlex.split(entry)
        assert program == "make" or program.startswith(".venv/bin/")
        assert [word for word in words if "/" in word and not (ROOT / word).exists()] == []


def test_forms_are_read() -> None:
    forms = [
        path for path in files_named(".yml") if path.parent.name == "ISSUE_TEMPLATE" and path.stem != "config"
    ]
    assert sorted(path.stem for path in forms) == ["problem", "wish"]
    for form in forms:
        fields = [field for field in _read(relative(form))["body"] if field["type"] != "markdown"]
        assert len({field["id"] for field in fields}) == len(fields)
