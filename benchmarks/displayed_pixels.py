"""When a page says that a picture is displayed, are its pixels on the screen? Chromium on an X server without one.

Everything that the platform says of motion to photon ends with what a page is told by its browser. Here a process
beside reads the X server's framebuffer twice a millisecond and notes when each tick's picture stands there. What a
real screen adds, up to one of its periods and its panel's own time, no software sees.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np
from report import Bar, report
from support.framebuffer import PixelWatch, chromium_on, screen
from support.moving_scene import PERIOD_S, moving_scene
from support.networked_video import show
from support.watching_page import Displayed

from mart.protocol.errors import Unavailable

FRAMES_PER_S, SECONDS = 30.0, 20.0
SCREEN_MS = 1000 / 60


def pixels_after_ms(displayed: Displayed, seen: Sequence[tuple[float, int]]) -> np.ndarray:
    """Return how long after the page's word each picture stood in the framebuffer, ms; below 0: before.

    Pictures repeat after PERIOD_S, so each is looked for around its time.
    """
    at_ms, ticks = np.array([at for at, _ in seen]), np.array([tick for _, tick in seen])
    half_ms = 1e3 * PERIOD_S / 2
    after = []
    for page_ms, tick in zip(displayed.at_ms, displayed.ticks, strict=True):
        same = at_ms[(ticks == tick) & (np.abs(at_ms - page_ms) < half_ms)]
        if len(same):
            after.append(same[0] - page_ms)
    return np.array(after)


def main() -> int:
    pictures = list(moving_scene(FRAMES_PER_S, int(PERIOD_S * FRAMES_PER_S)))
    try:
        with screen() as (display, pixels), chromium_on(display) as chromium, PixelWatch(pixels) as watch:
            displayed = show(pictures, FRAMES_PER_S, (), SECONDS, follows=True, executable=chromium)
    except Unavailable as error:
        print(error, file=sys.stderr)
        return 1
    after_ms = pixels_after_ms(displayed, watch.seen)
    metrics = {
        "pictures": len(after_ms),
        "page_said_per_s": len(displayed.at_ms) / SECONDS,
        "found_share": len(after_ms) / max(1, len(displayed.at_ms)),
        "pixels_after_page_p5_ms": float(np.percentile(after_ms, 5)),
        "pixels_after_page_p50_ms": float(np.percentile(after_ms, 50)),
        "pixels_after_page_p95_ms": float(np.percentile(after_ms, 95)),
        "drawn_to_page_p50_ms": float(np.median(displayed.delay_ms)),
    }
    bars = [
        Bar.at_least("pictures found in the framebuffer, share", metrics["found_share"], 0.95),
        Bar.at_most("pixels after the page's word, p95, ms", metrics["pixels_after_page_p95_ms"], SCREEN_MS),
    ]
    report("displayed_pixels", metrics, {"screen_period_ms": SCREEN_MS}, bars)
    return 0


if __name__ == "__main__":
    sys.exit(main())
