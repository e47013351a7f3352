"""Log lines for programs: one JSON object each, whatever is in them."""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator
from typing import Any

import pytest

from mart.runtime import log_format
from mart.runtime.log_format import configure_logging, set_log_context


@pytest.fixture(autouse=True)
def _own_log(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Leave the tests' own log as it was."""
    root = logging.getLogger()
    before, level = root.handlers[:], root.level
    monkeypatch.setattr(log_format, "_context", {})
    root.handlers = []
    yield
    root.handlers = before
    root.setLevel(level)


def _entry(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    (line,) = capsys.readouterr().err.splitlines()
    entry: dict[str, Any] = json.loads(line)
    return entry


def test_a_line_says_when_who_and_of_what(capsys: pytest.CaptureFixture[str]) -> None:
    configure_logging("info", "seat", "room-1-arm0", "json")
    set_log_context(room="room-1", seat="arm0")
    logging.getLogger("mart.there").info("%d is\nsaved", 3, extra={"episode": 3})
    entry = _entry(capsys)
    assert entry.pop("time").endswith("Z")
    assert entry == {
        "level": "INFO",
        "service": "seat",
        "id": "room-1-arm0",
        "logger": "mart.there",
        "message": "3 is\nsaved",
        "room": "room-1",
        "seat": "arm0",
        "episode": 3,
    }


def test_a_line_s_own_word_goes_before_that_of_its_process(capsys: pytest.CaptureFixture[str]) -> None:
    configure_logging("info", "recorder", "recorder-1", "json")
    set_log_context(room="room-1")
    logging.getLogger("mart").warning("here", extra={"room": "room-2"})
    assert _entry(capsys)["room"] == "room-2"


def test_an_exception_is_in_the_same_line(capsys: pytest.CaptureFixture[str]) -> None:
    configure_logging("info", "web", "web", "json")
    try:
        int("so it was")
    except ValueError:
        logging.getLogger("mart").exception("failed")
    entry = _entry(capsys)
    assert "ValueError: invalid literal" in entry["exception"]


def test_people_read_what_they_always_read(capsys: pytest.CaptureFixture[str]) -> None:
    configure_logging("info", "web")
    logging.getLogger("mart").info("hello")
    assert capsys.readouterr().err.endswith("INFO    web       hello\n")
