"""The operator's page draws by itself where that is asked for, and shows video wherever it cannot draw or must not."""

from __future__ import annotations

import queue

from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from playwright.sync_api import Browser, Page, expect

from mart.platform.run.running import Platform
from mart.protocol import keys
from mart.protocol.codec import decode
from mart.protocol.messages import Event
from mart.runtime.bus.base import Sample
from tests.browser.pages.visits import driving, seen_in, visit

WAIT_S = 60.0
SHOWN = "#drawn:not([hidden])"
# What is sent as bytes are a hand's frames.
LATE_FRAMES = """
  const { send } = RTCDataChannel.prototype;
  RTCDataChannel.prototype.send = function (data) {
    if (typeof data === "string") send.call(this, data);
    else setTimeout(() => this.readyState === "open" && send.call(this, data), 400);
  };
"""
IS_AS_LARGE_AS_THE_PICTURE = """() => {
  const [told, picture] = ["commanded", "picture"].map((id) => document.getElementById(id).getBoundingClientRect());
  return ["x", "y", "width", "height"].every((side) => Math.abs(told[side] - picture[side]) < 1);
}"""
LOSE = (
    "document.querySelector('#drawn').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()"
)


class Said:
    """The latency events of a room, and its pictures."""

    def __init__(self, platform: Platform) -> None:
        self.latencies: queue.Queue[Event.Latency] = queue.Queue()
        self.pictures: queue.Queue[CompressedVideo] = queue.Queue()
        room = platform.options.room
        platform.bus.subscribe(keys.event(room).key, self._on_event)
        platform.bus.subscribe(keys.video(room, "arm0").key, self._on_picture)

    def await_drawn(self, by_page: bool) -> Event.Latency:
        """The next report of a picture that is drawn so."""
        while (latency := self.latencies.get(timeout=WAIT_S)).drawn_in_page is not by_page:
            pass
        return latency

    def pictures_from_now(self, page: Page) -> int:
        """How many pictures the server makes in a second."""
        while not self.pictures.empty():
            self.pictures.get_nowait()
        page.wait_for_timeout(1000)
        return self.pictures.qsize()

    def _on_event(self, sample: Sample) -> None:
        event = decode(Event, sample.payload)
        if event.WhichOneof("what") == "latency":
            self.latencies.put(event.latency)

    def _on_picture(self, sample: Sample) -> None:
        self.pictures.put(decode(CompressedVideo, sample.payload))


def test_a_page_that_draws_costs_the_server_no_picture_and_a_lost_context_brings_video(
    browser: Browser, platform: Platform
) -> None:
    said = Said(platform)
    with visit(browser, platform, "small") as at, driving(at):
        page = at.page
        page.goto(f"{page.url}?picture=drawn")
        expect(page.locator(SHOWN)).to_be_visible()
        assert said.await_drawn(by_page=True).draw_p50_ms > 0
        page.keyboard.press("c")
        expect(page.locator("#second")).to_have_text("Overview")
        at.is_fine("operator-drawn-second-view")
        for _ in range(2):  # the other arm's side, and none
            page.keyboard.press("c")
        expect(page.locator("#second")).to_be_hidden()
        assert said.pictures_from_now(page) <= 1
        page.locator("#health summary").click()
        expect(page.locator("#breakdown")).to_contain_text("drawn here")
        page.evaluate(LOSE)
        expect(page.locator("#drawn")).to_be_hidden()
        expect(page.locator(SHOWN)).to_be_visible()  # on a new canvas
        at.noise.clear()  # browsers and three.js tell of a lost context aloud


def test_a_device_without_a_graphics_card_shows_video_and_says_why(
    browser: Browser, platform: Platform
) -> None:
    said = Said(platform)
    with visit(browser, platform, "small") as at, driving(at):
        said.await_drawn(by_page=False)
        at.page.locator("#health summary").click()
        expect(at.page.locator("#breakdown")).to_contain_text("without a graphics card")
        assert said.pictures_from_now(at.page) > 3
        assert at.page.locator("#drawn").count() == 0


def test_where_the_way_is_long_video_shows_where_the_tool_was_told_to_go(
    browser: Browser, platform: Platform
) -> None:
    with visit(browser, platform, "small") as at:
        at.context.add_init_script(LATE_FRAMES)
        with driving(at) as page:
            told = page.locator("#commanded")
            expect(page.locator("#rate")).to_contain_text(
                "real time"
            )  # the seat is heard, and hears open hands
            page.keyboard.down("Space")
            page.keyboard.down("w")
            expect(told).to_be_visible()
            for name in seen_in(
                page, [("narrow", "dark"), ("sideways", "light"), ("small", "light")], "commanded"
            ):
                at.is_fine(name)
                assert page.evaluate(IS_AS_LARGE_AS_THE_PICTURE), name
            page.keyboard.up("w")
            page.keyboard.up("Space")
            expect(told).to_be_hidden()
