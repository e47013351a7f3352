"""Rooms from the lobby: opened, closed, and where that is not offered, why."""

from __future__ import annotations

from playwright.sync_api import Browser, Request, Route, expect

from mart.platform.run.running import Platform
from tests.browser.pages.visits import FEW_LOOKS, visit

CARD_WITHOUT_PICTURE = """async () => {
  const { roomCard } = await import("/static/js/room-card.js");
  const { rooms } = await (await fetch("/api/rooms")).json();
  const card = roomCard((action) => action(), () => {});
  card.node.id = "unseen";
  document.body.append(card.node);
  card.update({ ...rooms[0], room: "nowhere", task: "own_task", still: 9 }, []);
}"""


def test_a_room_is_opened_and_closed_from_the_lobby(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana:
        ana.join("Ana", "Join and choose a seat")
        cards = ana.page.locator("article.room")
        expect(cards).to_have_count(1)
        ana.page.get_by_text("New room", exact=True).click()
        ana.page.get_by_label("Task").select_option("Lift and wipe")
        ana.page.get_by_label("Good episodes wanted").fill("50")
        ana.page.get_by_text("Kinds of arms: all Pandas").click()
        ana.page.locator("#new-kind-arm1").select_option("Universal Robots UR5e")
        ana.page.locator("#new-end-arm2").select_option("Wiping pad: no fingers, wipes")
        expect(ana.page.get_by_text("Kinds of arms: 2 chosen")).to_be_visible()
        ana.is_fine("lobby-new-room")
        ana.page.get_by_role("button", name="Open room").click()
        expect(cards).to_have_count(2)
        expect(cards.nth(1).locator(".seat")).to_have_count(3)
        expect(cards.nth(1)).to_contain_text("Episode 1 of 50")
        expect(cards.nth(1)).to_contain_text("Arms: panda, ur5e, panda+wiping_pad")
        expect(cards.nth(0)).not_to_contain_text("Episode ")
        # No picture has these arms: the words take its place.
        words, card = (cards.nth(1).locator(at).bounding_box() for at in ("header", "xpath=."))
        assert words is not None
        assert card is not None
        assert words["width"] > 0.8 * card["width"]
        ana.is_fine("lobby-two-rooms")
        for _ in range(2):
            cards.nth(1).locator("button.close").click()
        expect(cards).to_have_count(1)


def test_a_room_without_any_picture_asks_for_each_once(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana:
        ana.join("Ana", "Join and choose a seat")
        expect(ana.page.locator("article.room")).to_have_count(1)
        asked: list[Request] = []
        ana.page.on("request", lambda request: asked.extend([request]))
        ana.page.evaluate(CARD_WITHOUT_PICTURE)
        expect(ana.page.locator("#unseen img")).to_be_hidden()
        ana.page.wait_for_timeout(500)
        images = [one.url.rpartition("/")[2] for one in asked if one.resource_type == "image"]
        assert images == ["still?number=9", "own_task.jpg"]
        ana.noise.clear()  # of the browser, about both


def test_where_nothing_opens_rooms_the_lobby_says_why_and_how(browser: Browser, platform: Platform) -> None:
    def without_platform(route: Route) -> None:
        answer = route.fetch()
        route.fulfill(json={**answer.json(), "opens_rooms": False})

    with visit(browser, platform) as ana:
        ana.page.route("**/api/tasks", without_platform)
        ana.join("Ana", "Join and choose a seat")
        ana.page.get_by_text("New room", exact=True).click()
        expect(ana.page.locator("#rooms-elsewhere")).to_contain_text("none is allowed to start another")
        expect(ana.page.locator("#task-names")).to_contain_text("three_arm_lift_wiping")
        expect(ana.page.get_by_role("button", name="Close room: room-1")).to_be_hidden()
        ana.is_fine_in(FEW_LOOKS, "lobby-rooms-elsewhere")
