from __future__ import annotations

import asyncio
import datetime as dt
import ssl
from pathlib import Path

import pytest

from mart.web.access.certificate import Certificate, ensure_certificate
from mart.web.app import certificate_renewal
from mart.web.app.certificate_renewal import keep_renewed

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
