"""A page of a real Chromium that notes when it displays each picture of a video, and what that says of a sender."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from playwright.async_api import Page, async_playwright

from mart.platform.collect.browser import ARGUMENTS, chromium_path

SETTLE_S = 5.0  # left out: the connection comes about, and the first packets are lost
_WATCH = (Path(__file__).parent / "watch_video.js").read_text()


@dataclass(frozen=True)
class Displayed:
    """Hold when pictures were displayed, Unix time in ms, and how long after they were drawn.

    kbit_s: that were encoded. memory_mb: of the sender at most, until the begin and until the end. ticks: of each
    picture, where that was looked for.
    """

    at_ms: np.ndarray[Any, np.dtype[np.float64]]
    delay_ms: np.ndarray[Any, np.dtype[np.float64]]
    kbit_s: float = 0.0
    memory_mb: tuple[float, float] = (0.0, 0.0)
    ticks: Sequence[int] = ()

    def freezes(self, longer_ms: float = 200.0) -> int:
        """Count the gaps that are so much longer than the usual one."""
        gaps_ms = np.diff(self.at_ms)
        return int(np.sum(gaps_ms > np.median(gaps_ms) + longer_ms))


@contextlib.asynccontextmanager
async def watching_page(executable: Path | None = None) -> AsyncIterator[Page]:
    """Open a page in a Chromium, or in what starts one."""
    async with async_playwright() as playwright:
        arguments = [*ARGUMENTS, "--disable-features=WebRtcHideLocalIpsWithMdns"]
        path = executable or chromium_path()
        browser = await playwright.chromium.launch(executable_path=path, args=arguments)
        yield await browser.new_page()
        await browser.close()


async def offer_of(page: Page, *, shows_at_once: bool = True) -> str:
    """Return the SDP with which the page asks for a video, shown as it comes or as browsers do by themselves."""
    offer: str = await page.evaluate(f"({_WATCH})({str(shows_at_once).lower()})")
    return offer


async def accept(page: Page, answer: str) -> None:
    """Give the page the SDP of who answered."""
    await page.evaluate("sdp => window.peer.setRemoteDescription({type: 'answer', sdp})", answer)


async def shown(
    page: Page, drawn_ms: Mapping[int, float]
) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Return when pictures were displayed, how long after they were drawn, in ms, and their time stamps.

    The beginning is left out.

    drawn_ms: when each was drawn, by its RTP time stamp.
    """
    rows = [row for row in await page.evaluate("() => window.shown") if row[1] in drawn_ms]
    at_ms = np.array([at_ms for at_ms, _ in rows])
    delay_ms = np.array([at_ms - drawn_ms[pts] for at_ms, pts in rows])
    settled = at_ms > at_ms[0] + 1e3 * SETTLE_S if len(at_ms) else np.zeros(0, bool)
    return at_ms[settled], delay_ms[settled], np.array([pts for _, pts in rows], np.int64)[settled]
