"""A bar on a terminal, and nothing anywhere else."""

from __future__ import annotations

import io
import sys

import pytest

from mart.runtime.progress import progress, tracked


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_terminal_sees_how_far_it_is(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    assert list(tracked(["a", "b"], "Files")) == ["a", "b"]
    assert "Files" in terminal.getvalue()
    assert "2/2" in terminal.getvalue()
    with progress("Updates", 8) as shown:
        shown.reach(4)
        shown.say("halfway")
        shown.reach(8)
    assert "4/8" in terminal.getvalue()
    assert "8/8" in terminal.getvalue()
    assert capsys.readouterr().out == "halfway\n"


@pytest.mark.parametrize("terminal", [True, False])
def test_programs_and_files_see_nothing_of_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], terminal: bool
) -> None:
    stderr = Terminal() if terminal else io.StringIO()
    monkeypatch.setattr(sys, "stderr", stderr)
    with progress("Files", 3, as_json=terminal) as shown:
        shown.advance()
        shown.reach(3)
        shown.say("line")
    assert stderr.getvalue() == ""
    assert capsys.readouterr().out == "line\n"


def test_nothing_to_do_is_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", Terminal())
    assert list(tracked([], "Files")) == []
