"""The page's reader of motions: which tick is shown at a second, and where that puts a tool."""

from __future__ import annotations

import struct

import pytest
from playwright.sync_api import Error

from tests.browser.pages.conftest import Run

HALF = 23170  # the square root of a half, in 1/32767
TURNED = (100, 200, 300, HALF, 0, 0, HALF)  # a quarter turn around z
MOTION = """async ({ Motion }, bytes) => {
  const { toolWays } = await import("/static/js/episodes/tool-ways.js");
  const motion = new Motion(new Uint8Array(bytes).buffer);
  const tool = { body: 0, position_m: [0.1, 0, 0] };
  const ways = toolWays({ bodies: ["arm0/hand"], plumb_lines: [tool] }, motion);
  return { rows: [-1, 0, 0.04, 0.05, 0.2, 9].map((s) => motion.at(s)), way: Array.from(ways.get("arm0")) };
}"""


def motion(seconds: list[float]) -> bytes:
    rows = [
        struct.pack("<d4s4sQfHH7h", at_s, b"MBP1", bytes(4), tick, 0.001, 1, 0, *TURNED)
        for tick, at_s in enumerate(seconds)
    ]
    return struct.pack("<4sI", b"MMO1", len(rows[0])) + b"".join(rows)


def test_the_newest_tick_is_shown_and_tools_are_where_their_bodies_have_them(run: Run) -> None:
    told = run("episodes/motion.js", MOTION, list(motion([0.0, 0.05, 0.1])))
    assert told["rows"] == [0, 0, 0, 1, 2, 2]
    assert told["way"] == pytest.approx([0.1, 0.3, 0.3] * 3, abs=1e-4)


@pytest.mark.parametrize("bytes_", [b"", b"MMO1", motion([0.0])[:-1], b"XXXX" + motion([0.0])[4:]])
def test_what_is_no_motion_is_refused(run: Run, bytes_: bytes) -> None:
    with pytest.raises(Error, match="no motion that could be shown"):
        run("episodes/motion.js", MOTION, list(bytes_))
