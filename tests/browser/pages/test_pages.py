"""Every page in a real Chromium, narrow and wide, dark and light: legible, whole, quiet, and usable by keyboard."""

from __future__ import annotations

from playwright.sync_api import Browser, Page, expect

from mart.platform.run.running import Platform
from tests.browser.pages.legibility import faults
from tests.browser.pages.visits import FEW_LOOKS, LOOKS, SCREENSHOTS, Visit, driving, seen_in, visit

FOCUSED = """() => {
  const at = document.activeElement;
  return at.matches("body") ? "" : at.id || at.innerText;
}"""


def tab_through(page: Page) -> list[str]:
    """What the Tab key reaches, in order, until it comes round."""
    reached: list[str] = []
    while True:
        page.keyboard.press("Tab")
        at = page.evaluate(FOCUSED)
        if at in reached or not at:
            return reached
        outline = page.evaluate("() => getComputedStyle(document.activeElement).outlineStyle")
        assert outline != "none", f"the focus on {at!r} cannot be seen"
        reached.append(at)


def test_the_lobby_is_legible_and_shows_others_the_way(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana:
        ana.page.goto(f"{platform.url}#code={platform.join_code}")
        expect(ana.page.get_by_role("button", name="Try it")).to_be_visible()
        ana.is_fine_in(LOOKS, "join")
        ana.join("Ana", "Join and choose a seat")
        expect(ana.page.locator(".seat").first).to_be_visible()
        ana.is_fine_in(LOOKS, "lobby")
        ana.page.get_by_text("Invite others").click()
        card = ana.page.locator("#invite")
        expect(card).to_contain_text(platform.join_code)
        expect(card).to_contain_text("--host 0.0.0.0")  # this platform listens for nobody else
        expect(card.get_by_role("img")).to_have_js_property("complete", True)
        ana.is_fine_in(FEW_LOOKS, "invite")


def test_what_a_press_failed_at_stays_to_be_read(browser: Browser, platform: Platform) -> None:
    """Though news of the rooms come five times a second."""
    with visit(browser, platform) as ana:
        with ana.page.expect_websocket() as live:
            ana.join("Ana", "Join and choose a seat")
        ana.page.route("**/seats/arm0", lambda route: route.abort())
        ana.page.get_by_role("button", name="Try it").click()
        message = ana.page.locator("#lobby-message")
        expect(message).to_contain_text("cannot be reached")
        for _ in range(3):
            live.value.wait_for_event("framereceived")
        expect(message).to_contain_text("cannot be reached")


COVERED = """() => {
  const picture = document.querySelector("#picture").getBoundingClientRect();
  return [".strip", ".edge", ".partners"].filter((name) => {
    const box = document.querySelector(name).getBoundingClientRect();
    return box.left < picture.right - 1 && box.right > picture.left + 1
      && box.top < picture.bottom - 1 && box.bottom > picture.top + 1;
  });
}"""


def test_the_operators_page_is_legible_and_on_small_screens_nothing_stands_over_the_picture(
    browser: Browser, platform: Platform
) -> None:
    with visit(browser, platform) as ana, driving(ana) as page:
        expect(page.get_by_role("button", name="Ready")).to_be_visible()
        expect(page.locator("#delay")).not_to_contain_text("–")
        ana.is_fine_in(LOOKS, "operator")
        for what in seen_in(page, [(size, "light") for size in ("small", "sideways", "narrow")], "uncovered"):
            assert page.evaluate(COVERED) == [], what
            expect(page.locator("#stop")).to_be_in_viewport(ratio=1)
            ana.is_fine(what)
        page.locator("#health summary").click()
        page.get_by_role("button", name="Pair a phone").click()
        expect(page.locator("#qr")).to_be_visible()
        ana.is_fine_in(LOOKS, "operator-pairing")


def test_the_lobby_is_reached_by_keyboard(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana:
        ana.page.goto(platform.url)
        expect(ana.page.locator("#name")).to_be_focused()
        ana.page.keyboard.type("Ana")
        ana.page.keyboard.press("Tab")
        ana.page.keyboard.type(platform.join_code)
        ana.page.keyboard.press("Tab")
        ana.page.keyboard.press("Tab")
        ana.page.keyboard.press("Enter")
        expect(ana.page.locator(".seat").first).to_be_visible()
        assert "Take seat" in tab_through(ana.page)


def test_one_drives_commands_and_leaves_by_keys_and_pointer(browser: Browser, platform: Platform) -> None:
    """One visit; what each part checks is its name."""
    with visit(browser, platform) as ana, driving(ana) as page:
        everything_is_reached_by_keyboard(page)
        the_strip_leaves_the_picture_and_can_be_made_smaller(page)
        practice_is_reset_by_a_key(page)
        help_and_gripper_have_keys(ana)
        space_drives_after_a_button_was_pressed_by_key(page)
        what_was_looked_at_gives_space_back_to_the_arm(page)
        dragging_the_picture_moves_the_arm(page)
        q_twice_right_after_driving_leaves_the_seat(page)


def everything_is_reached_by_keyboard(page: Page) -> None:
    expect(page.get_by_role("button", name="Ready")).to_be_visible()
    reached = tab_through(page)
    assert {"leave", "gripper", "pair", "toggle", "stop", "help"} <= set(reached)
    assert any(one.startswith("Ready") for one in reached)


def the_strip_leaves_the_picture_and_can_be_made_smaller(page: Page) -> None:
    now, strip = page.locator("#state-now"), page.locator(".strip")
    expect(now).to_have_text("Grip the blue cube from above and lift it more than 10 cm.")
    whole = strip.bounding_box()
    assert whole is not None
    assert whole["height"] < 0.2 * 900
    page.get_by_role("button", name="Less").click()
    page.reload()  # it stays as it was left
    expect(page.get_by_role("button", name="More")).to_be_visible()
    expect(now).to_be_visible()
    less = strip.bounding_box()
    assert less is not None
    assert less["height"] < whole["height"] - 30
    page.get_by_role("button", name="More").click()
    expect(page.locator("#picture.live")).to_be_visible()


def practice_is_reset_by_a_key(page: Page) -> None:
    expect(page.locator("#subtasks li")).to_have_count(2)
    with page.expect_response("**/api/rooms/room-1/episode") as answered:
        page.keyboard.press("r")
    assert answered.value.ok
    assert answered.value.request.post_data_json == {"action": "reset", "arm": "arm0"}


def help_and_gripper_have_keys(ana: Visit) -> None:
    page = ana.page
    page.keyboard.press("?")
    expect(page.locator("#keys")).to_be_visible()
    ana.is_fine("operator-keys")
    page.keyboard.press("?")
    expect(page.locator("#keys")).to_be_hidden()
    page.keyboard.press("g")
    expect(page.locator("#gripper")).to_have_text("Open gripper")
    page.keyboard.press("k")
    expect(page.locator("#gripper")).to_have_text("Close gripper")


def space_drives_after_a_button_was_pressed_by_key(page: Page) -> None:
    for closes in ("Escape", "?"):
        page.locator("#help").focus()
        page.keyboard.press("Enter")
        expect(page.locator("#keys")).to_be_visible()
        page.keyboard.press(closes)
        expect(page.locator("#keys")).to_be_hidden()
        page.keyboard.down("Space")
        expect(page.locator("#clutch")).to_have_text("Moving")
        page.keyboard.up("Space")
        expect(page.locator("#keys")).to_be_hidden()


def what_was_looked_at_gives_space_back_to_the_arm(page: Page) -> None:
    for _ in range(2):
        page.locator("#health summary").click()
    page.keyboard.down("Space")
    expect(page.locator("#clutch")).to_have_text("Moving")
    page.keyboard.up("Space")
    assert not page.locator("#health").evaluate("details => details.open")


def dragging_the_picture_moves_the_arm(page: Page) -> None:
    page.mouse.move(720, 400)
    page.mouse.down()
    page.mouse.move(760, 380, steps=5)
    expect(page.locator("#clutch")).to_have_text("Moving")
    page.mouse.up()
    expect(page.locator("#clutch")).to_contain_text("Hold space")
    page.mouse.wheel(0, -200)
    expect(page.locator("#clutch")).to_have_text("Moving")
    expect(page.locator("#clutch")).to_contain_text("Hold space")


def q_twice_right_after_driving_leaves_the_seat(page: Page) -> None:
    page.keyboard.down("Space")
    page.keyboard.down("KeyQ")
    expect(page.locator("#clutch")).to_have_text("Moving")
    page.keyboard.up("KeyQ")
    page.keyboard.up("Space")
    page.keyboard.press("q")
    page.keyboard.press("q")
    expect(page.locator("#rooms-section")).to_be_visible()


def test_an_outcome_takes_two_presses_and_a_moving_hand_none(browser: Browser, platform: Platform) -> None:
    """S is also the key that moves the arm back."""
    with visit(browser, platform) as ana, driving(ana) as page:
        label = page.locator("#state-label")
        page.keyboard.press("n")
        expect(label).to_have_text("Recording")
        page.keyboard.down("Space")
        page.keyboard.down("KeyS")
        expect(page.locator("#clutch")).to_have_text("Moving")
        page.keyboard.up("KeyS")
        page.keyboard.up("Space")
        page.keyboard.press("s")
        page.keyboard.press("s")  # right after letting go: still meant to move
        expect(page.locator("#clutch")).to_contain_text("Hold space")
        expect(label).to_have_text("Recording")
        page.locator("#state-label").click()
        page.keyboard.press("r")
        expect(page.get_by_role("button", name="Press again: Discard")).to_be_visible()
        expect(label).to_have_text("Recording")
        page.keyboard.press("r")
        expect(label).to_have_text("Discarded")
        expect(page.locator("#state-detail")).to_contain_text("left out of data sets")
        page.get_by_role("button", name="Keep it, as failed").click()
        expect(label).to_have_text("Failed")
        expect(page.locator("#state-detail")).to_contain_text("Saved and verified")


def test_a_script_is_taken_over_from_and_handed_back_to(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana:
        ana.join("Ana", "Join and choose a seat")
        ana.page.get_by_label("Who drives the blue arm in room-1").select_option("Script")
        expect(ana.page.get_by_role("button", name="Take over: Blue arm")).to_be_visible()
        ana.page.goto(f"{platform.url}rooms/room-1/arms/arm0")
        expect(ana.page.get_by_role("button", name="Take over")).to_be_visible()
        ana.page.keyboard.press("n")
        expect(ana.page.locator("#picture.live")).to_be_visible()
        expect(ana.page.get_by_role("button", name="Hand back")).to_be_visible()
        ana.is_fine("operator-taken-over")
        ana.page.keyboard.press("b")
        expect(ana.page.get_by_role("button", name="Take over")).to_be_visible()
        ana.is_fine("operator-beside-a-script")
        ana.page.goto(platform.url)
        ana.page.get_by_label("Who drives the blue arm in room-1").select_option("Free")


def test_the_health_page(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana:
        ana.join("Ana", "Join and choose a seat")
        ana.page.get_by_role("link", name="Health").click()
        expect(ana.page.get_by_role("heading", name="Everything is well")).to_be_visible()
        expect(ana.page.locator(".finding", has_text="Certificate")).to_contain_text("good for")
        ana.is_fine_in(FEW_LOOKS, "health")


def test_a_page_that_does_not_exist_leads_home(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform, "narrow", "dark") as ana:
        ana.join("Ana", "Join and choose a seat")
        expect(ana.page.locator(".seat").first).to_be_visible()
        ana.page.goto(f"{platform.url}rooms/room-9/arms/arm0")
        expect(ana.page.get_by_role("button", name="Go to the lobby")).to_be_visible()
        ana.page.screenshot(path=SCREENSHOTS / "operator-unknown.png", full_page=True)
        assert faults(ana.page) == []
        ana.noise.clear()  # the browser tells of the seat that is not there, and of the page below
        answer = ana.page.goto(f"{platform.url}nowhere")
        assert answer is not None
        assert answer.status == 404
        expect(ana.page.get_by_role("link", name="Go to the lobby")).to_be_visible()
        assert faults(ana.page) == []
        assert ana.page.evaluate("() => getComputedStyle(document.querySelector('main')).display") == "grid"
