from __future__ import annotations

import asyncio
import datetime as dt
import ssl
from pathlib import Path

import pytest

from mart.web.access.certificate import Certificate, ensure_certificate
from mart.web.app import certificate_renewal
from mart.web.app.certificate_renewal import RETRY_S, keep_renewed

pytestmark = pytest.mark.anyio


async def test_a_renewal_that_fails_is_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(certificate_renewal, "RETRY_S", 0.0)
    renewed = asyncio.Event()
    tries = 0

    def ensure() -> Certificate:
        nonlocal tries
        tries += 1
        if tries == 1:
            raise OSError(28, "No space left on device")
        renewed.set()
        return ensure_certificate(tmp_path, ["localhost"], dt.datetime.now(dt.UTC))

    renewing = asyncio.ensure_future(keep_renewed(ensure, ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)))
    await asyncio.wait_for(renewed.wait(), 30)
    renewing.cancel()
    assert "could not be renewed" in caplog.text


@pytest.mark.parametrize(("due_s", "wait_s"), [(30 * 86400.0, 30 * 86400.0), (-5.0, RETRY_S)])
async def test_it_is_looked_at_again_when_it_is_due_and_never_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, due_s: float, wait_s: float
) -> None:
    made = ensure_certificate(tmp_path, ["localhost"], dt.datetime.now(dt.UTC))
    now = made.renew_at - dt.timedelta(seconds=due_s)
    slept: asyncio.Future[float] = asyncio.get_running_loop().create_future()

    async def sleep(delay_s: float) -> None:
        slept.set_result(delay_s)
        await asyncio.Event().wait()

    monkeypatch.setattr(certificate_renewal, "now", lambda: now)
    with monkeypatch.context() as patched:
        patched.setattr(asyncio, "sleep", sleep)
        renewing = asyncio.ensure_future(keep_renewed(lambda: made, ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)))
        assert await slept == wait_s
        renewing.cancel()
