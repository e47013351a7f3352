"""What the phone's one button for episodes offers."""

from __future__ import annotations

from typing import Any

import pytest

from tests.browser.pages.conftest import Run


@pytest.mark.parametrize(
    ("status", "again", "text"),
    [
        ({}, False, "Ready"),
        ({}, True, "Again"),
        ({"ready": True}, True, "Not ready yet"),
        ({"practises_only": True}, False, None),
        ({"phase": "recording"}, False, "Discard"),
        ({"phase": "ended"}, True, None),
    ],
)
def test_the_button_of_the_episode_offers_what_can_be_done(
    run: Run, status: dict[str, Any], again: bool, text: str | None
) -> None:
    status = {"phase": "practice", "ready": False, "practises_only": False} | status
    script = "({ nextAction }, { status, again }) => nextAction(status, again)?.text ?? null"
    assert run("phone/episode-button.js", script, {"status": status, "again": again}) == text
