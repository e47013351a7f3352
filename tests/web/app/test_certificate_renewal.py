from __future__ import annotations

import asyncio

import pytest

from mart.web.app import certificate_renewal
from mart.web.app.certificate_renewal import keep_renewed

pytestmark = pytest.mark.anyio


async def look(monkeypatch: pytest.MonkeyPatch, answers: list[int | Exception]) -> list[int]:
    """Which of the certificates that `answers` name, one a look, were loaded."""
    monkeypatch.setattr(certificate_renewal, "LOOK_EVERY_S", 0.0)
    looked, waiting = asyncio.Event(), iter(answers)
    there, loaded = [0], []

    def ensure() -> int:
        answer = next(waiting, None)
        if answer is None:
            looked.set()
        elif isinstance(answer, Exception):
            raise answer
        else:
            there[0] = answer
        return there[0]

    renewing = asyncio.ensure_future(keep_renewed(ensure, lambda: loaded.append(there[0])))
    await asyncio.wait_for(looked.wait(), 30)
    renewing.cancel()
    return loaded


async def test_a_certificate_is_loaded_once_and_another_when_it_is_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert await look(monkeypatch, [1, 1, 1, 2, 2]) == [1, 2]


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), ValueError("no name")])
async def test_whatever_fails_is_told_once_and_tried_again(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, error: Exception
) -> None:
    assert await look(monkeypatch, [1, error, error, error, 2]) == [1, 2]
    assert caplog.text.count("could not be renewed") == 1


def test_it_looks_often_enough_for_a_laptop_that_sleeps() -> None:
    assert certificate_renewal.LOOK_EVERY_S <= 60.0
