"""The page that says whether a device is ready: what it says of what it found, and what it finds here."""

from __future__ import annotations

from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from mart.platform.run.running import Platform
from tests.browser.pages.conftest import Run
from tests.browser.pages.visits import FEW_LOOKS, visit

VERDICT = "(verdicts, [name, ...given]) => verdicts[name](...given)"
GOOD = {"p50Ms": 12, "p95Ms": 20, "jitterMs": 3, "lossShare": 0}


def verdict(run: Run, name: str, *given: Any) -> Any:
    return run("check/verdicts.js", VERDICT, [name, *given])


def test_round_trips_are_summed_up(run: Run) -> None:
    trips = "({ roundTrips }, trips) => roundTrips(trips)"
    told = run("check/round-trips.js", trips, [10, 20, None, 10, 20])
    assert told == {"p50Ms": 20, "p95Ms": 20, "jitterMs": 10, "lossShare": pytest.approx(0.2)}
    assert run("check/round-trips.js", trips, [None]) is None


@pytest.mark.parametrize(
    ("name", "given", "kind", "words"),
    [
        ("secureRow", [{"secure": False, "address": "http://a/check", "certificateDays": 9}], "poor", "https://a"),
        ("secureRow", [{"secure": True, "address": "", "certificateDays": 2.5}], "poor", "renewed"),
        ("secureRow", [{"secure": True, "address": "", "certificateDays": None}], "well", ""),
        ("clockRow", [86_400 * 1.0], "poor", "network"),
        ("clockRow", [3.0], "well", ""),
        ("connectionRow", [None, False], "poor", "join code"),
        ("connectionRow", [{"way": "none", "trips": None, "problem": ""}, False], "poor", "relay (TURN)"),
        ("connectionRow", [{"way": "none", "trips": None, "problem": ""}, True], "poor", "over TLS"),
        ("connectionRow", [{"way": "none", "trips": None, "problem": "No gateway runs."}, True], "poor", "No gateway"),
        ("connectionRow", [{"way": "relay", "trips": None, "problem": ""}, True], "well", ""),
        ("relayRow", [None], "idle", ""),
        ("relayRow", [{"way": "none", "trips": None, "problem": ""}], "poor", "host"),
        ("codecRow", [{"h264": False, "vp8": True}], "well", ""),
        ("codecRow", [{"h264": False, "vp8": False}], "poor", "Chrome"),
        ("drawingRow", [None], "idle", ""),
        ("drawingRow", [{"renderer": "GPU", "software": False, "drawMs": 3}], "well", ""),
        ("drawingRow", [{"renderer": "llvmpipe", "software": True, "drawMs": 90}], "idle", ""),
        ("xrRow", [{"ar": False, "vr": False}, True], "idle", ""),
        ("motionRow", ["denied", True], "poor", "Allow motion"),
        ("motionRow", ["silent", True], "poor", "Allow motion"),
        ("motionRow", ["silent", False], "idle", ""),
        ("gamepadRow", [["Pad"]], "well", ""),
    ],
)  # fmt: skip
def test_each_row_has_a_verdict_and_its_mend(
    run: Run, name: str, given: list[Any], kind: str, words: str
) -> None:
    row = verdict(run, name, *given)
    assert row["kind"] == kind
    assert words in row["mend"]
    assert bool(row["mend"]) == (kind == "poor")


def test_a_slow_or_uneven_way_is_named(run: Run) -> None:
    def kinds(**other: float) -> list[str]:
        return [row["kind"] for row in verdict(run, "delayRows", GOOD | other, True)]

    assert kinds() == ["well", "well"]
    assert kinds(p50Ms=300) == ["poor", "well"]
    assert kinds(lossShare=0.1) == ["well", "poor"]
    assert [row["name"] for row in verdict(run, "delayRows", GOOD, False)] == ["Delay"]


def test_it_ends_in_one_word_or_in_what_to_do_first(run: Run) -> None:
    fine = {"kind": "well", "needed": True, "mend": ""}
    assert verdict(run, "conclusion", [fine]) == {"title": "Ready", "first": ""}
    late = {"kind": "poor", "needed": False, "mend": "Use a cable."}
    assert verdict(run, "conclusion", [fine, late])["title"] == "Ready"
    dead = {"kind": "poor", "needed": True, "mend": "Try another network."}
    assert verdict(run, "conclusion", [late, dead, fine]) == {
        "title": "Not ready", "first": "Try another network.",
    }  # fmt: skip


def test_a_device_is_checked_before_one_has_joined(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana:
        page = ana.page
        page.goto(platform.url)
        page.get_by_role("link", name="See whether it is ready").click()
        expect(page.get_by_role("heading", name="Not checked yet")).to_be_visible()
        expect(page.locator("#first")).to_contain_text("join code")
        expect(page.locator(".finding", has_text="Delay")).to_contain_text("over HTTPS")
        ana.noise.clear()  # the browser tells of each 401
        page.get_by_label("Join code").fill(platform.join_code)
        page.get_by_role("button", name="Try the connection").click()
        expect(page.get_by_role("heading", name="Ready", exact=True)).to_be_visible()
        expect(page.locator(".finding", has_text="Way to the server")).to_contain_text("direct")
        expect(page.locator(".finding", has_text="WebGL")).to_contain_text("a picture")
        ana.is_fine_in(FEW_LOOKS, "check")


def test_a_wrong_code_says_so(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana:
        ana.page.goto(f"{platform.url}check#code=WRONG-CODE")
        expect(ana.page.locator("#code-error")).to_contain_text("not right")
