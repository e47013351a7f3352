"""Gamepad and SpaceMouse as a hand: what their sticks, caps and buttons ask for."""

from __future__ import annotations

import struct
from typing import Any

import pytest

from tests.browser.pages.conftest import Run

PAD = """({ GamepadHand }, seen) => {
  const hand = new GamepadHand();
  const pad = ({ axes, held = [] }) => ({
    axes,
    buttons: Array.from({ length: 17 }, (_, at) => ({ pressed: held.includes(at), value: Number(held.includes(at)) })),
  });
  return seen.map((one) => hand.see(one && pad(one)));
}"""
STILL = {"axes": [0, 0, 0, 0]}


def test_a_gamepad_moves_while_its_sticks_are_off_their_rest(run: Run) -> None:
    pushed = {"axes": [0, -1, 0, 0]}
    drifting = {"axes": [0.1, -0.1, 0.05, 0]}
    turning = {"axes": [0, 0, 1, 0], "held": [7]}
    told = run("drive/gamepad-hand.js", PAD, [STILL, pushed, drifting, turning, None])
    motions = [one["motion"] for one in told]
    assert [motion["engaged"] for motion in motions] == [False, True, False, True, False]
    assert motions[1]["move"] == pytest.approx([0, 0, -1])
    assert motions[3]["move"] == pytest.approx([0, 1, 0])
    assert motions[3]["turn"] == pytest.approx([0, -1, 0])


def test_a_gamepad_that_comes_with_its_stick_held_moves_nothing(run: Run) -> None:
    pushed = {"axes": [1, 0, 0, 0], "held": [0]}
    told = run("drive/gamepad-hand.js", PAD, [pushed, pushed, STILL, pushed, None, pushed])
    assert [one["motion"]["engaged"] for one in told] == [False, False, False, True, False, False]
    assert [one["commands"] for one in told] == [[], [], [], ["gripper"], [], []]


def test_a_button_that_stays_pressed_commands_once(run: Run) -> None:
    held = {"axes": [0, 0, 0, 0], "held": [0, 8]}
    told = run("drive/gamepad-hand.js", PAD, [STILL, held, held, STILL, held])
    assert [one["commands"] for one in told] == [[], ["gripper", "stop"], [], [], ["gripper", "stop"]]


CAP = """({ SpaceMouseHand }, { reports, nowMs }) => {
  const hand = new SpaceMouseHand();
  const commands = reports.map(([id, bytes]) => hand.take(id, new DataView(Uint8Array.from(bytes).buffer), 0));
  return { commands, ...hand.motion(nowMs) };
}"""


def cap(run: Run, *reports: tuple[int, bytes], now_ms: float = 10.0) -> Any:
    asked = {"reports": [[number, list(data)] for number, data in reports], "nowMs": now_ms}
    return run("drive/spacemouse-hand.js", CAP, asked)


def test_a_space_mouse_moves_along_the_screens_axes(run: Run) -> None:
    right_and_up = struct.pack("<3h", 350, 0, -350)
    told = cap(run, (1, right_and_up), (2, struct.pack("<3h", 0, 0, 0)))
    assert told["engaged"]
    assert told["move"] == pytest.approx([1, 1, 0])
    both = cap(run, (1, struct.pack("<6h", 0, -350, 0, 0, 0, 700)))
    assert both["move"] == pytest.approx([0, 0, -1])
    assert both["turn"] == pytest.approx([0, -1, 0])


def test_a_space_mouse_that_rests_or_is_silent_moves_nothing(run: Run) -> None:
    pushed = struct.pack("<3h", 350, 0, 0)
    assert not cap(run, (1, struct.pack("<3h", 12, -9, 4)))["engaged"]
    assert not cap(run, (1, pushed), now_ms=400.0)["engaged"]
    assert not cap(run, (1, pushed[:3]), (9, pushed))["engaged"]
    assert cap(run, (3, b"\x01"), (3, b"\x01"), (3, b"\x00"))["commands"] == [["gripper"], [], []]
