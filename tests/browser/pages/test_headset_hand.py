"""A headset's controllers as a hand: when they lead, what their buttons ask for, and where the person stands."""

from __future__ import annotations

import math
from typing import Any

import pytest

from tests.browser.pages.conftest import Run

HAND = """({ ControllerHand }, steps) => {
  const hand = new ControllerHand();
  const controller = ({ side = "right", at = [0, 0, 0], ...pressed }) => ({
    side, pose: at && { position: at, quaternionWxyz: [1, 0, 0, 0] },
    squeeze: 0, trigger: 0, stick: [0, 0], lower: false, upper: false, stickPressed: false, ...pressed,
  });
  let nowMs = 0;
  return steps.map(({ seen = [], gripper = 0, afterMs = 16, call }) => {
    nowMs += afterMs;
    if (call) hand[call]();
    const commands = call ? [] : hand.see(seen.map(controller), gripper, nowMs);
    return { commands, side: hand.side, ...hand.reading(nowMs) };
  });
}"""
IDLE: dict[str, Any] = {"seen": [{}]}
HELD = {"seen": [{"squeeze": 1}]}


def led(run: Run, *steps: dict[str, Any]) -> list[dict[str, Any]]:
    told: list[dict[str, Any]] = run("headset/controller-hand.js", HAND, list(steps))
    return told


def test_a_squeeze_leads_from_when_it_is_pressed_until_it_is_let_go(run: Run) -> None:
    nearly = {"seen": [{"squeeze": 0.5}]}
    told = led(run, IDLE, nearly, HELD, nearly, {"seen": [{"squeeze": 0.2}]}, nearly)
    assert [one["engaged"] for one in told] == [False, False, True, True, False, False]
    assert all(one["tracking"] for one in told)


def test_a_squeeze_that_was_held_before_the_controller_came_leads_nothing(run: Run) -> None:
    gone: dict[str, Any] = {"seen": []}
    told = led(run, HELD, HELD, IDLE, HELD, gone, HELD, {"call": "lose"}, HELD, IDLE, HELD)
    assert [one["engaged"] for one in told] == [
        False, False, False, True, False, False, False, False, False, True
    ]  # fmt: skip
    assert not told[4]["tracking"]


def test_a_recentred_room_opens_the_clutch_until_the_next_press(run: Run) -> None:
    told = led(run, IDLE, HELD, {"call": "letGo"}, HELD, IDLE, HELD)
    assert [one["engaged"] for one in told] == [False, True, False, False, False, True]


def test_the_other_controller_takes_over_only_while_none_leads(run: Run) -> None:
    def both(left: float, right: float) -> dict[str, Any]:
        return {"seen": [{"side": "left", "at": [1, 0, 0], "squeeze": left}, {"squeeze": right}]}

    later = {
        **both(1, 0),
        "afterMs": 60,
    }  # its place is told before its press: a change of place would be a jump
    told = led(run, both(0, 0), both(1, 0), later, both(1, 1), both(0, 1), both(0, 0), both(0, 1))
    assert [one["side"] for one in told] == ["right", "left", "left", "left", "left", "left", "right"]
    assert [one["engaged"] for one in told] == [False, False, True, True, False, False, False]
    assert told[1]["position"] == [1, 0, 0]


def test_a_pose_that_is_guessed_or_old_is_not_tracked(run: Run) -> None:
    lost = {"seen": [{"at": None, "squeeze": 1}]}
    told = led(run, IDLE, HELD, lost)
    assert [one["tracking"] for one in told] == [True, True, False]
    assert told[2]["engaged"]  # the gateway demands another press
    aged = run(
        "headset/controller-hand.js",
        "({ ControllerHand }) => { const hand = new ControllerHand(); const none = [0, 0];"
        " const pose = { position: [0, 0, 0], quaternionWxyz: [1, 0, 0, 0] };"
        " hand.see([{ side: 'right', pose, squeeze: 0, trigger: 0, stick: none, lower: false, upper: false }], 0, 0);"
        " return [100, 200].map((nowMs) => hand.reading(nowMs).tracking); }",
    )
    assert aged == [True, False]


def test_a_trigger_that_springs_back_drops_nothing(run: Run) -> None:
    def pulled(trigger: float, gripper: float, squeeze: float = 1) -> dict[str, Any]:
        return {"seen": [{"squeeze": squeeze, "trigger": trigger}], "gripper": gripper}

    told = led(
        run,
        IDLE,
        pulled(0, 0),
        pulled(0.8, 0),
        pulled(0.8, 0.8, squeeze=0),  # repositioned
        pulled(0, 0.8, squeeze=0),
        pulled(0, 0.8),
        pulled(0.5, 0.8),
        pulled(0.75, 0.8),  # as far as it is closed: it leads again
        pulled(0.1, 0.75),
    )
    assert [one["gripper"] for one in told] == [None, 0, 0.8, None, None, None, None, 0.75, 0.1]


def test_the_stop_button_has_to_be_held_and_stops_once(run: Run) -> None:
    held = {"seen": [{"upper": True}], "afterMs": 300}
    told = led(run, IDLE, held, held, IDLE, held, held, held, held)
    assert [one["commands"] for one in told] == [[], [], [], [], [], [], ["stop"], []]


def test_the_lower_button_asks_for_what_comes_next_or_says_a_word(run: Run) -> None:
    down = {"seen": [{"lower": True}]}
    up, right, nothing = (
        {"seen": [{"lower": True, "stick": stick}]} for stick in ((0, -1), (1, 0.1), (-0.8, -0.8))
    )
    told = led(run, IDLE, down, IDLE, up, down, IDLE, up, right, IDLE, down, nothing, IDLE)
    assert [one["commands"] for one in told if one["commands"]] == [["next"], ["have_it"], ["wait"]]
    assert led(run, down, IDLE)[1]["commands"] == []  # it was held before anybody looked


def test_the_pressed_stick_asks_for_what_it_was_pushed_to_last(run: Run) -> None:
    def pushed(*stick: float) -> dict[str, Any]:
        return {"seen": [{"stickPressed": True, "stick": stick}]}

    told = led(
        run, IDLE, pushed(0, -1), IDLE, pushed(0, 0), IDLE, pushed(1, 0), pushed(-1, 0), pushed(0, 0), IDLE
    )
    assert [one["commands"] for one in told if one["commands"]] == [["success"], ["leave"]]
    pressed_meanwhile = led(run, IDLE, pushed(0, 1), {"call": "lose"}, pushed(0, 1), IDLE)
    assert [one["commands"] for one in pressed_meanwhile] == [[]] * 5  # the system's menu lay over it


STAND = """({ standOf, levelAxes }, { position, quaternionWxyz, eyesM, right }) =>
  [standOf({ position, quaternionWxyz }, eyesM), levelAxes(right)]"""


def test_whoever_comes_stands_before_the_scene_and_looks_to_it(run: Run) -> None:
    yaw, pitch = 1.2, -0.7
    turned = (math.cos(yaw / 2), 0.0, math.sin(yaw / 2), 0.0)
    nodding = (math.cos(pitch / 2), math.sin(pitch / 2))
    head = (turned[0] * nodding[0], turned[0] * nodding[1], turned[2] * nodding[0], -turned[2] * nodding[1])
    asked = {"position": [2, 1.7, -3], "quaternionWxyz": head, "eyesM": None, "right": [0.6, -0.8, 0.3]}
    stand, axes = run("headset/stand.js", STAND, asked)
    assert stand["position"] == [2, 0, -3]
    assert stand["quaternionWxyz"] == pytest.approx(turned)
    assert axes["right"] == pytest.approx([0.6, -0.8, 0])
    assert axes["towards"] == pytest.approx([-0.8, -0.6, 0])
    stand, _ = run("headset/stand.js", STAND, {**asked, "eyesM": 1.6})
    assert stand["position"] == pytest.approx([2, 0.1, -3])


TURN = """({ turnBetween, turned, isRight }, { from, to }) => {
  const turn = turnBetween(from.quaternionWxyz, to.quaternionWxyz);
  return [turned({ position: [1, 2, 3], quaternionWxyz: [1, 0, 0, 0] }, turn), isRight(from, to.position)];
}"""


def test_a_hand_is_turned_into_the_axes_of_another_seat(run: Run) -> None:
    """A camera that looks along y (down by 0.7 rad) has x to its right; one that looks along -x has y."""
    down = (math.cos((math.pi / 2 - 0.7) / 2), math.sin((math.pi / 2 - 0.7) / 2))
    quarter = math.sqrt(0.5)
    along_y = {"position": [0, 0, 1], "quaternionWxyz": [down[0], down[1], 0, 0]}
    along_minus_x = {
        "position": [1, 5, 1],
        "quaternionWxyz": [quarter * down[0], quarter * down[1], quarter * down[1], quarter * down[0]],
    }
    (turned, is_right) = run("headset/stand.js", TURN, {"from": along_y, "to": along_minus_x})
    assert turned["position"] == pytest.approx([-3, 2, 1])  # towards was -y, which is left there
    assert is_right
    assert not run("headset/stand.js", TURN, {"from": along_minus_x, "to": along_y})[1]


def test_a_boards_lines_fit_and_lose_no_word(run: Run) -> None:
    script = "({ wrapped }, [line, width]) => wrapped(line, (text) => text.length, width)"
    line = "Grip the blue cube from above"
    rows = run("headset/board.js", script, [line, 12])
    assert " ".join(rows) == line
    assert all(len(row) <= 12 for row in rows)
    assert run("headset/board.js", script, ["extraordinarily", 4]) == ["extraordinarily"]
