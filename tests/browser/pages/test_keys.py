"""Which keys move, which command, and what has to be pressed twice."""

from __future__ import annotations

from tests.browser.pages.conftest import Run

TYPED = """({ Keyboard }, typed) => {
  const said = [];
  new Keyboard((...told) => said.push(told), () => said.push("clutch"));
  for (const key of typed) {
    const [, sign, code] = key.match(/^([+-])(.*)$/);
    dispatchEvent(new KeyboardEvent(sign === "+" ? "keydown" : "keyup", { code }));
  }
  return said;
}"""


def test_held_keys_add_up_to_a_direction(run: Run) -> None:
    ask = "({ directionOf }, held) => directionOf(new Set(held))"
    assert run("drive/keys.js", ask, ["KeyW", "KeyA", "KeyQ"]) == {"move": [-1, 1, -1], "turn": [0, 0, 0]}
    assert run("drive/keys.js", ask, ["KeyW", "KeyS", "Space"]) == {"move": [0, 0, 0], "turn": [0, 0, 0]}


def test_letters_move_while_space_is_held_and_command_as_soon_as_it_is_let_go(run: Run) -> None:
    moving = ["+Space", "+KeyS", "-KeyS", "-Space"]
    then = ["+KeyQ", "-KeyQ", "+KeyQ", "-KeyQ", "+KeyS", "-KeyS"]
    assert run("drive/keyboard.js", TYPED, [*moving, *then]) == [
        "clutch",
        ["leave", False],
        ["leave", False],
        ["success", True],  # a hand that has just moved with it may go on
    ]
    held = ["+Space", "+KeyQ", "-Space", "-KeyQ", "+KeyQ"]
    assert run("drive/keyboard.js", TYPED, held) == ["clutch", ["leave", True]]


def test_what_is_asked_twice_is_withdrawn_by_driving_on(run: Run) -> None:
    script = """({ Confirm }) => {
      const confirm = new Confirm(() => {});
      const presses = [confirm.press("leave"), confirm.press("leave"), confirm.press("success")];
      confirm.withdraw();
      return [...presses, confirm.pending, confirm.press("success"), confirm.press("success")];
    }"""
    assert run("hud/confirm.js", script) == [False, True, False, "", False, True]
