"""A page's patience with a silent seat: an outage of seconds costs no new connection."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser, expect

from mart.platform.run.running import Platform
from tests.browser.pages.conftest import Run
from tests.browser.pages.visits import driving, visit
from tests.support.crashing import frozen_seat_process, frozen_service

COUNTED = """
globalThis.connections = 0;
globalThis.RTCPeerConnection = new Proxy(RTCPeerConnection, {
  construct: (...given) => { connections += 1; return Reflect.construct(...given); },
});"""

OUTAGE = """({ Patience, Verdict }, { untilMs, siteMs }) => {
  const [patience, told, lastWordMs] = [new Patience(), [], 300];
  let isLost = null; // once the site is asked, which answers at siteMs
  patience.begin(0);
  for (let nowMs = 500; nowMs <= 20_000; nowMs += 50) {
    if (nowMs <= 1000 || nowMs >= untilMs) patience.heard(nowMs);
    const verdict = patience.verdict(nowMs);
    if (verdict !== told.at(-1)?.[0]) told.push([verdict, nowMs]);
    if (verdict === Verdict.ASK) isLost ??= patience.ask();
    if (verdict === Verdict.LOST || (isLost?.() && nowMs >= siteMs + lastWordMs)) return { told, lostMs: nowMs };
  }
  return { told, lostMs: null };
}"""


@pytest.mark.parametrize("outage_ms", [200, 1_000, 3_000, 5_000])
def test_an_outage_of_seconds_makes_no_new_connection(run: Run, outage_ms: int) -> None:
    """The site answers as late as the seat speaks again: it was the network."""
    until_ms = 1_000 + outage_ms
    borne = run("link/patience.js", OUTAGE, {"untilMs": until_ms, "siteMs": until_ms})
    assert borne["lostMs"] is None
    assert borne["told"][-1] == ["fine", until_ms] or outage_ms == 200
    silent = [at_ms for verdict, at_ms in borne["told"] if verdict == "silent"]
    assert silent == ([] if outage_ms == 200 else [1_300])


def test_a_seat_that_is_gone_while_the_site_answers_is_connected_anew_soon(run: Run) -> None:
    borne = run("link/patience.js", OUTAGE, {"untilMs": 1e9, "siteMs": 2_600})
    assert borne["lostMs"] == 2_900


def test_patience_ends_where_nothing_answers(run: Run) -> None:
    borne = run("link/patience.js", OUTAGE, {"untilMs": 1e9, "siteMs": 1e9})
    assert borne["lostMs"] == 7_050


def test_a_connection_that_never_spoke_is_given_fifteen_seconds(run: Run) -> None:
    script = """({ Patience }) => {
      const patience = new Patience();
      patience.begin(1000);
      return [2000, 9000, 16_000, 16_001].map((nowMs) => patience.verdict(nowMs));
    }"""
    assert run("link/patience.js", script) == ["fine", "fine", "fine", "lost"]


def test_a_dark_network_is_waited_for(platform: Platform, browser: Browser) -> None:
    """Neither site nor seat is heard for longer than the site's answer takes, and then both."""
    with visit(browser, platform) as visited:
        visited.context.add_init_script(COUNTED)
        with driving(visited) as page:
            page.keyboard.down("Space")
            expect(page.locator("#clutch")).to_have_text("Moving")
            with frozen_service(platform, "web"), frozen_seat_process(platform, "arm0"):
                expect(page.locator("#picture.live")).to_be_hidden()
                expect(page.locator("#clutch")).to_have_text("No link: the arm holds still.")
                expect(page.locator("body.engaged")).to_have_count(0)
                page.keyboard.up("Space")
                page.wait_for_timeout(2_300)  # a lease of the bus is 4 s
            expect(page.locator("#picture.live")).to_be_visible()
            assert page.evaluate("() => connections") == 1
